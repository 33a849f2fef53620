#include "converters/import/gltf_file.h"

#include <algorithm>
#include <filesystem>

#include "converters/import/gltf_normal.h"
#include "converters/import/mesh_message.h"
#include "converters/import/plain_file.h"
#include "converters/worker/worker.h"
#include "format/byte_reader.h"
#include "format/byte_writer.h"

namespace mesocell {
namespace {

namespace fs = std::filesystem;

Error bad_gltf(std::string message) { return {ErrorCode::kInvalidInput, std::move(message)}; }

Result<std::vector<std::byte>> ask(MeshRequest kind, std::span<const std::byte> bytes, const char* subject,
                                   const Progress* progress) {
  ByteWriter request;
  request.reserve(4 + bytes.size());
  request.u32(std::uint32_t(kind));
  request.append(bytes);
  return run_worker(kMeshWorker, request.bytes(), subject, {}, progress);
}

/// Text and data of a glTF.
struct GltfChunks {
  std::string_view json;
  std::span<const std::byte> binary;
};

Result<GltfChunks> split(std::span<const std::byte> bytes) {
  const auto text = [](std::span<const std::byte> part) {
    return std::string_view(reinterpret_cast<const char*>(part.data()), part.size());
  };
  if (!text(bytes).starts_with("glTF")) return GltfChunks{text(bytes), {}};
  ByteReader in(bytes);
  in.skip(4);
  const std::uint32_t version = in.u32(), length = in.u32();
  if (!in.overrun() && version != 2)
    return bad_gltf("the file is a GLB of glTF " + std::to_string(version) +
                    ", not 2.0; export the scene again");
  if (in.overrun() || length > bytes.size())
    return bad_gltf("the GLB promises " + std::to_string(length) + " bytes, but the file has " +
                    std::to_string(bytes.size()) + "; it is cut off, fetch or export it again");
  GltfChunks chunks;
  in = ByteReader(bytes.first(length));
  in.skip(12);
  for (int i = 0; i < 2 && in.remaining() >= 8; ++i) {
    const std::uint32_t size = in.u32(), type = in.u32();
    const auto chunk = in.take(size);
    if (in.overrun() || (i == 0 && type != 0x4e4f'534a))
      return bad_gltf("the chunks of the GLB are damaged; fetch or export it again");
    if (i == 0) chunks.json = text(chunk);
    if (i == 1 && type == 0x004e'4942) chunks.binary = chunk;
  }
  return chunks;
}

/// Undoes percent-encoding.
std::string decode_uri(const std::string& uri) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      path += char(std::uint8_t(16 * digit(uri[i + 1]) + digit(uri[i + 2])));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

/// Reads a file of the scene's folder or below.
Result<std::vector<std::byte>> read_beside(const fs::path& folder, const std::string& uri,
                                           std::uint64_t max_bytes, ReadNotes& notes) {
  const fs::path path = decode_uri(uri);
  const std::string text = path.string();
  const bool climbs = std::find(path.begin(), path.end(), "..") != path.end();
  if (path.empty() || path.is_absolute() || climbs || text.find(':') != text.npos ||
      text.find('\\') != text.npos || text.find('\0') != text.npos)
    return bad_gltf("only files in the scene's folder and below are read; put it there and name it so");
  notes.files.insert((folder / path).string());
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  const fs::path full = error ? fs::path() : fs::canonical(root / path, error);
  if (error) return Error{ErrorCode::kUnreadable, "there is no such file beside the scene; put it there"};
  // A link may lead out.
  if (std::mismatch(root.begin(), root.end(), full.begin(), full.end()).first != root.end())
    return bad_gltf("it is a link that leads out of the scene's folder; copy the file there");
  return read_plain_file(full.string(), max_bytes);
}

Result<WorkerMesh> take_mesh(const Result<std::vector<std::byte>>& reply) {
  if (!reply) return reply.error();
  return read_mesh_message(*reply);
}

}  // namespace

Result<WorkerMesh> read_gltf(std::span<const std::byte> bytes, const std::string& path,
                             std::uint64_t max_file_bytes, ReadNotes& notes, const Progress* progress) {
  const Result<GltfChunks> chunks = split(bytes);
  if (!chunks) return chunks.error();
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  const ResourceReader read = [&](const std::string& uri) -> Result<std::vector<std::byte>> {
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "interrupted"};
    return read_beside(folder, uri, max_file_bytes, notes);
  };
  std::vector<MeshWarning> warnings;
  const Result<std::vector<std::byte>> glb =
      normalize_gltf(chunks->json, chunks->binary, read, warnings, notes);
  if (!glb) return glb.error();
  Result<WorkerMesh> mesh = take_mesh(ask(MeshRequest::kGltf, *glb, "the scene", progress));
  if (mesh) mesh->warnings.insert(mesh->warnings.begin(), warnings.begin(), warnings.end());
  return mesh;
}

Result<WorkerMesh> read_draco(std::span<const std::byte> bytes, const Progress* progress) {
  return take_mesh(ask(MeshRequest::kDraco, bytes, "the mesh", progress));
}

Result<TextureImage> decode_texture(std::span<const std::byte> bytes, const Progress* progress) {
  const Result<std::vector<std::byte>> reply = ask(MeshRequest::kImage, bytes, "the picture", progress);
  if (!reply) return reply.error();
  return read_image_message(*reply);
}

}  // namespace mesocell
