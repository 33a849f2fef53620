#include "sdk/core/triangle_mesh.h"

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

}  // namespace mesocell
