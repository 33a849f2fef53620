#include <cmath>
#include <string>

#include "converters/import/mesh_message.h"
#include "converters/mesh_worker/draco_mesh.h"
#include "converters/mesh_worker/gltf_scene.h"
#include "converters/mesh_worker/texture_decoder.h"
#include "converters/worker/serve.h"
#include "format/byte_reader.h"

// Reads glTF, Draco and pictures for the command, in a process of its own: see converters/worker.

using namespace mesocell;

namespace {

Result<WorkerMesh> read_drc(std::span<const std::byte> bytes) {
  const Result<DracoMesh> draco = decode_draco(bytes, {});
  if (!draco) return draco.error();
  WorkerMesh read;
  TriangleMesh& mesh = read.painted.mesh;
  for (const auto& p : draco->attributes[0].values) {
    mesh.vertices.push_back({p[0], p[1], p[2]});
    if (!is_finite(mesh.vertices.back()))
      return Error{ErrorCode::kInvalidInput,
                   "the mesh has a vertex whose place is not finite (NaN or infinite); repair it"};
  }
  read.notes = draco->notes;
  const DracoValues& colors = draco->attributes[1];
  if (colors.components >= 3)
    for (const auto& c : colors.values) {
      Rgb8 color{};
      if (colors.components == 4 && c[3] < colors.full) read.notes.lose("alpha");
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = c[k] / colors.full;
        color[k] = x > 0 ? std::uint8_t(std::min(x, 1.0) * 255 + 0.5) : std::uint8_t(0);
      }
      mesh.colors.push_back(color);
    }
  read.polygons = draco->triangles.size();
  for (const Triangle& t : draco->triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      ++read.dropped_faces;
    else
      mesh.triangles.push_back(t);
  }
  return read;
}

Result<std::vector<std::byte>> handle(std::span<const std::byte> request) {
  ByteReader in(request);
  const auto kind = MeshRequest(in.u32());
  const auto bytes = in.take(in.remaining());
  if (kind == MeshRequest::kImage) {
    const Result<TextureImage> image = decode_picture(bytes, kMaxTexels);
    if (!image) return image.error();
    return write_image_message(*image);
  }
  const Result<WorkerMesh> mesh = kind == MeshRequest::kGltf ? read_gltf_scene(bytes) : read_drc(bytes);
  if (!mesh) return mesh.error();
  return write_mesh_message(*mesh);
}

}  // namespace

int main() { return serve_request(handle); }
