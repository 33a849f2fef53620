#include <limits>

#include "converters/export/mesh_formats.h"

namespace mesocell {

void write_ply(const MeshView& mesh, FileStream& out, WriteProgress& progress) {
  out.text("ply\nformat binary_little_endian 1.0\nelement vertex ");
  out.number(mesh.vertex_count);
  out.text("\nproperty double x\nproperty double y\nproperty double z\n");
  if (!mesh.normals.empty()) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (!mesh.colors.empty()) out.text("property uchar red\nproperty uchar green\nproperty uchar blue\n");
  out.text("element face ");
  out.number(mesh.triangle_count);
  // Programs know signed indices better.
  const bool is_signed = mesh.vertex_count <= std::uint64_t(std::numeric_limits<std::int32_t>::max());
  out.text(is_signed ? "\nproperty list uchar int vertex_indices\n"
                     : "\nproperty list uchar uint vertex_indices\n");
  out.text("end_header\n");
  for (std::uint64_t v = 0; v < mesh.vertex_count; ++v) {
    if (!progress.keep_on()) return;
    const Vec3 p = mesh.position(v);
    out.f64(p.x);
    out.f64(p.y);
    out.f64(p.z);
    if (!mesh.normals.empty())
      for (const float x : mesh.normals[v]) out.f32(x);
    if (!mesh.colors.empty())
      for (const std::uint8_t channel : mesh.colors[v]) out.u8(channel);
  }
  for (std::uint64_t k = 0; k < mesh.triangle_count; ++k) {
    if (!progress.keep_on()) return;
    out.u8(3);
    for (const std::uint32_t v : mesh.triangle(k)) out.u32(v);
  }
}

}  // namespace mesocell
