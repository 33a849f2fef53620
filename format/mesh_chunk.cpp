#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::uint32_t kDraco = 0;
constexpr std::uint64_t kMeshFieldBytes = 24;
constexpr std::uint32_t kMostCount = 0x7fffffff;

}  // namespace

std::vector<std::byte> encode_basic_mesh(const BasicMesh& mesh) {
  ByteWriter out;
  out.reserve(kPartAlignment + mesh.draco.size());
  out.u32(kDraco);
  out.f32(mesh.max_error);
  out.u64(mesh.draco.size());
  out.u32(mesh.vertices);
  out.u32(mesh.triangles);
  out.pad_to(kPartAlignment);
  out.append(mesh.draco);
  return out.release();
}

std::optional<BasicMesh> decode_basic_mesh(const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_header(chunk, sink)) return std::nullopt;
  ByteReader in(chunk.bytes);
  BasicMesh mesh;
  if (const std::uint32_t encoding = in.u32(); encoding != kDraco)
    add_issue(sink, IssueId::kMeshEncoding, chunk, 0, to_string(encoding));
  in.skip(4);
  mesh.max_error = check_stated_error(chunk, 4, sink);
  const std::uint64_t bytes = in.u64();
  mesh.vertices = in.u32();
  mesh.triangles = in.u32();
  if (bytes != chunk.bytes.size() - kPartAlignment)
    add_issue(sink, IssueId::kMeshBytes, chunk, 8,
              to_string(bytes) + " instead of " + to_string(chunk.bytes.size() - kPartAlignment));
  if (mesh.vertices < 3 || mesh.vertices > kMostCount || mesh.triangles < 1 || mesh.triangles > kMostCount)
    add_issue(sink, IssueId::kMeshCounts, chunk, 16,
              to_string(mesh.vertices) + " vertices, " + to_string(mesh.triangles) + " triangles");
  check_payload_zeros(chunk, kMeshFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  if (sink.errors() != errors_before) return std::nullopt;
  if (!budget.charge(bytes)) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for the basic mesh");
    return std::nullopt;
  }
  const auto stored = chunk.bytes.subspan(kPartAlignment);
  mesh.draco.assign(stored.begin(), stored.end());
  return mesh;
}

}  // namespace mesocell
