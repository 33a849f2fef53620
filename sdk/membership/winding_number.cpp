#include "sdk/membership/winding_number.h"

#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

/// What a triangle adds to the winding number about p, by whether the line from p along -x goes through it.
std::int32_t crossing(const std::array<Vec3, 3>& v, Vec3 p) {
  // The ε³ in z puts a vertex at the point's height below it. Then either no edge spans it or two do.
  int count = 0;
  bool beyond[2], upward[2];
  for (std::size_t e = 0; e < 3; ++e) {
    const Vec3 &a = v[e], &b = v[(e + 1) % 3];
    if ((a.z > p.z) == (b.z > p.z)) continue;
    upward[count] = a.z < b.z;
    const Vec3 &low = upward[count] ? a : b, &high = upward[count] ? b : a;
    // A point on the edge counts as beyond it: the ε² in y moves it there, whatever the ε³ in z does.
    beyond[count] = orientation_2d(low.y, low.z, high.y, high.z, p.y, p.z) <= 0;
    ++count;
  }
  if (count != 2 || beyond[0] == beyond[1]) return 0;
  // Seen along -x with y to the right, a counter-clockwise triangle runs down on its left.
  const std::int32_t delta = upward[beyond[0] ? 0 : 1] ? 1 : -1;
  // On the plane counts as beyond it: the ε in x moves it there.
  return delta * orientation_3d(v[0], v[1], v[2], p) <= 0 ? delta : 0;
}

}  // namespace

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
