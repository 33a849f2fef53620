#include "converters/export/mesh_formats.h"

namespace mesocell {

void write_obj(const MeshView& mesh, FileStream& out, WriteProgress& progress) {
  for (std::uint64_t v = 0; v < mesh.vertex_count; ++v) {
    if (!progress.keep_on()) return;
    const Vec3 p = mesh.position(v);
    out.text("v");
    for (std::size_t a = 0; a < 3; ++a) {
      out.text(" ");
      out.number(p[a]);
    }
    if (!mesh.colors.empty())
      for (const std::uint8_t channel : mesh.colors[v]) {
        out.text(" ");
        out.number(float(channel) / 255);
      }
    out.text("\n");
  }
  for (const auto& n : mesh.normals) {
    out.text("vn");
    for (const float x : n) {
      out.text(" ");
      out.number(x);
    }
    out.text("\n");
  }
  for (std::uint64_t k = 0; k < mesh.triangle_count; ++k) {
    if (!progress.keep_on()) return;
    out.text("f");
    for (const std::uint32_t v : mesh.triangle(k)) {
      out.text(" ");
      out.number(std::uint64_t{v} + 1);
      if (mesh.normals.empty()) continue;
      out.text("//");
      out.number(std::uint64_t{v} + 1);
    }
    out.text("\n");
  }
}

}  // namespace mesocell
