#include <algorithm>
#include <cmath>
#include <numeric>

#include "converters/export/mesh_formats.h"

namespace mesocell {
namespace {

using Single = std::array<float, 3>;

Single to_single(Vec3 p) { return {float(p.x), float(p.y), float(p.z)}; }

}  // namespace

SingleRounding round_to_single(const MeshView& mesh) {
  SingleRounding out;
  double largest = 0;
  for (std::uint64_t v = 0; v < mesh.vertex_count; ++v) {
    const Vec3 p = mesh.position(v);
    const Single s = to_single(p);
    out.greatest_move = std::max(out.greatest_move, length(p - Vec3{s[0], s[1], s[2]}));
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  // Singles next to each other are no farther apart than this.
  if (mesh.least_step > 0x1p-23 * largest) return out;
  std::vector<std::uint32_t> order(std::size_t(mesh.vertex_count));
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Single x = to_single(mesh.position(a)), y = to_single(mesh.position(b));
    return x != y ? x < y : to_array(mesh.position(a)) < to_array(mesh.position(b));
  });
  for (std::size_t k = 1; k < order.size() && !out.merges; ++k) {
    const Vec3 a = mesh.position(order[k - 1]), b = mesh.position(order[k]);
    out.merges = !(a == b) && to_single(a) == to_single(b);
  }
  return out;
}

void write_stl(const MeshView& mesh, FileStream& out, WriteProgress& progress) {
  // A text STL begins with "solid"; this does not.
  std::string header = "binary STL, metres";
  header.resize(80, ' ');
  out.text(header);
  out.u32(std::uint32_t(mesh.triangle_count));
  for (std::uint64_t k = 0; k < mesh.triangle_count; ++k) {
    if (!progress.keep_on()) return;
    const Triangle t = mesh.triangle(k);
    const Vec3 a = mesh.position(t[0]), b = mesh.position(t[1]), c = mesh.position(t[2]);
    for (const float x : to_single(normalize(cross(b - a, c - a)))) out.f32(x);
    for (const Vec3& p : {a, b, c})
      for (const float x : to_single(p)) out.f32(x);
    out.u16(0);
  }
}

}  // namespace mesocell
