#include "sdk/core/triangle_mesh.h"

#include <algorithm>
#include <numeric>

namespace mesocell {

Box3 bounding_box(const TriangleMesh& mesh) {
  Box3 box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) box.add(mesh.vertices[v]);
  return box;
}

double signed_volume(const TriangleMesh& mesh) {
  const Box3 box = bounding_box(mesh);
  if (box.empty()) return 0;
  // About the centre, not the origin: far from it the terms would cancel.
  const Vec3 c = box.min + box.extent() * 0.5;
  double six = 0;
  for (const Triangle& t : mesh.triangles)
    six += dot(mesh.vertices[t[0]] - c, cross(mesh.vertices[t[1]] - c, mesh.vertices[t[2]] - c));
  return six / 6;
}

std::vector<std::uint32_t> merge_identical_vertices(const std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = vertices[a], &q = vertices[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> merged(vertices.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    merged[order[k]] =
        k > 0 && vertices[order[k]] == vertices[order[k - 1]] ? merged[order[k - 1]] : order[k];
  return merged;
}

}  // namespace mesocell
