#include "sdk/membership/solid.h"

#include <utility>
#include <vector>

#include "sdk/membership/mesh_topology.h"

namespace mesocell {

TriangleMesh turn_outward(TriangleMesh mesh) {
  const std::vector<Triangle> corners = merge_corners(mesh);
  const Components components = edge_components(corners, EdgeTable(corners));
  std::vector<Box3> boxes(components.count);
  std::vector<double> volumes(components.count, 0);
  const auto for_triangles = [&](auto f) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (components.of_triangle[t] != kNoComponent) f(components.of_triangle[t], mesh.triangles[t]);
  };
  for_triangles([&](std::uint32_t c, const Triangle& t) {
    for (const std::uint32_t v : t) boxes[c].add(mesh.vertices[v]);
  });
  for_triangles([&](std::uint32_t c, const Triangle& t) {
    const Vec3 middle = (boxes[c].min + boxes[c].max) / 2;
    volumes[c] +=
        dot(mesh.vertices[t[0]] - middle, cross(mesh.vertices[t[1]] - middle, mesh.vertices[t[2]] - middle));
  });
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (components.of_triangle[t] != kNoComponent && volumes[components.of_triangle[t]] < 0)
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return mesh;
}

}  // namespace mesocell
