#include "converters/export/mesh_formats.h"

namespace mesocell {

void write_off(const MeshView& mesh, FileStream& out, WriteProgress& progress) {
  out.text(mesh.colors.empty() ? "OFF\n" : "COFF\n");
  out.number(mesh.vertex_count);
  out.text(" ");
  out.number(mesh.triangle_count);
  out.text(" 0\n");
  for (std::uint64_t v = 0; v < mesh.vertex_count; ++v) {
    if (!progress.keep_on()) return;
    const Vec3 p = mesh.position(v);
    out.number(p.x);
    out.text(" ");
    out.number(p.y);
    out.text(" ");
    out.number(p.z);
    if (!mesh.colors.empty()) {
      for (const std::uint8_t channel : mesh.colors[v]) {
        out.text(" ");
        out.number(unsigned{channel});
      }
      out.text(" 255");  // the alpha says that channels are integers, too
    }
    out.text("\n");
  }
  for (std::uint64_t k = 0; k < mesh.triangle_count; ++k) {
    if (!progress.keep_on()) return;
    out.text("3");
    for (const std::uint32_t v : mesh.triangle(k)) {
      out.text(" ");
      out.number(v);
    }
    out.text("\n");
  }
}

}  // namespace mesocell
