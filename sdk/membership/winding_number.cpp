#include "sdk/membership/winding_number.h"

#include "sdk/membership/crossing.h"

namespace mesocell {

WindingNumber::WindingNumber(const TriangleMesh& mesh, unsigned threads) {
  std::vector<Box3> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) boxes[t].add(mesh.vertices[v]);
  tree_ = BoxTree(boxes, threads);
  triangles_.reserve(boxes.size());
  for (const std::uint32_t t : tree_.order()) {
    const Triangle& v = mesh.triangles[t];
    triangles_.push_back({mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]});
  }
}

std::int32_t WindingNumber::at(Vec3 p) const {
  const Box3 all = tree_.box();
  if (triangles_.empty() || !(all.min.x <= p.x)) return 0;
  std::int32_t winding = 0;
  tree_.visit_overlapping(Box3{{all.min.x, p.y, p.z}, p}, [&](std::uint32_t place) {
    winding += crossing(triangles_[place], p);
    return true;
  });
  return winding;
}

}  // namespace mesocell
