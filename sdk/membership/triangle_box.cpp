#include "sdk/membership/triangle_box.h"

#include <algorithm>

#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

/// Whether an edge of the triangle, seen along an axis, has the whole box strictly on the side away from the
/// rest of the triangle: a plane through the edge along the axis then separates them.
bool edge_separates(const Vec3& p, const Vec3& q, const Vec3& rest, const Vec3& low, const Vec3& high,
                    std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto side = [&](double x, double y) { return orientation_2d(p[u], p[v], q[u], q[v], x, y); };
  const int box = side(low[u], low[v]);
  if (box == 0) return false;
  if (side(high[u], low[v]) != box || side(low[u], high[v]) != box || side(high[u], high[v]) != box)
    return false;
  return side(rest[u], rest[v]) != box;
}

}  // namespace

bool triangle_meets_box(const std::array<Vec3, 3>& t, const Vec3& low, const Vec3& high) {
  // Two disjoint convex polytopes are separated by a plane along a face of one, or along an edge of each.
  for (std::size_t a = 0; a < 3; ++a)
    if (std::max({t[0][a], t[1][a], t[2][a]}) < low[a] || std::min({t[0][a], t[1][a], t[2][a]}) > high[a])
      return false;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t e = 0; e < 3; ++e)
      if (edge_separates(t[e], t[(e + 1) % 3], t[(e + 2) % 3], low, high, axis)) return false;
  int first = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner{k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z};
    const int side = orientation_3d(t[0], t[1], t[2], corner);
    if (side == 0 || (k > 0 && side != first)) return true;
    first = side;
  }
  return false;
}

}  // namespace mesocell
