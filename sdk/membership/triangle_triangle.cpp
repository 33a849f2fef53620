#include "sdk/membership/triangle_triangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

int orientation_along(std::size_t axis, Vec3 a, Vec3 b, Vec3 c) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  return orientation_2d(a[u], a[v], b[u], b[v], c[u], c[v]);
}

/// An axis along which the triangle does not look like a segment; the likeliest is tried first.
std::size_t projection_axis(const std::array<Vec3, 3>& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(n[a]) > std::abs(n[axis])) axis = a;
  for (std::size_t k = 0; k < 2 && orientation_along(axis, t[0], t[1], t[2]) == 0; ++k) axis = (axis + 1) % 3;
  return axis;
}

/// Whether r, on the line through p and q as seen along the axis, is between them or at one.
bool between(std::size_t axis, Vec3 p, Vec3 q, Vec3 r) {
  for (const std::size_t c : {(axis + 1) % 3, (axis + 2) % 3})
    if (r[c] < std::min(p[c], q[c]) || r[c] > std::max(p[c], q[c])) return false;
  return true;
}

bool segments_meet(std::size_t axis, Vec3 p, Vec3 q, Vec3 a, Vec3 b) {
  const int pa = orientation_along(axis, p, q, a), pb = orientation_along(axis, p, q, b);
  if (pa * pb > 0) return false;
  const int ap = orientation_along(axis, a, b, p), aq = orientation_along(axis, a, b, q);
  if (ap * aq > 0) return false;
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && between(axis, p, q, a)) || (pb == 0 && between(axis, p, q, b)) ||
         (ap == 0 && between(axis, a, b, p)) || (aq == 0 && between(axis, a, b, q));
}

/// In a common plane: whether the point is in the triangle, seen along an axis that does not lie in it.
bool inside_in_plane(std::size_t axis, Vec3 p, const std::array<Vec3, 3>& t) {
  const int turn = orientation_along(axis, t[0], t[1], t[2]);
  for (std::size_t k = 0; k < 3; ++k)
    if (orientation_along(axis, t[k], t[(k + 1) % 3], p) * turn < 0) return false;
  return true;
}

/// Likewise whether the segment meets the triangle.
bool meets_in_plane(std::size_t axis, Vec3 p, Vec3 q, const std::array<Vec3, 3>& t) {
  if (inside_in_plane(axis, p, t)) return true;
  for (std::size_t k = 0; k < 3; ++k)
    if (segments_meet(axis, p, q, t[k], t[(k + 1) % 3])) return true;
  return false;
}

/// Which side of a triangle's plane a point is on; 0: in it. Planes across an axis, of which grids and walls
/// are full, need no determinant; which side is +1 may differ there.
int side(const std::array<Vec3, 3>& t, Vec3 p) {
  for (std::size_t a = 0; a < 3; ++a)
    if (t[0][a] == t[1][a] && t[0][a] == t[2][a]) return p[a] > t[0][a] ? 1 : p[a] < t[0][a] ? -1 : 0;
  return orientation_3d(t[0], t[1], t[2], p);
}

/// Whether the boxes of a segment and a triangle have no point in common.
bool apart(Vec3 p, Vec3 q, const std::array<Vec3, 3>& t) {
  for (std::size_t a = 0; a < 3; ++a)
    if (std::max(p[a], q[a]) < std::min({t[0][a], t[1][a], t[2][a]}) ||
        std::min(p[a], q[a]) > std::max({t[0][a], t[1][a], t[2][a]}))
      return true;
  return false;
}

/// Whether a closed segment meets a closed triangle, given the sides of the triangle's plane its ends are on.
bool segment_meets(Vec3 p, int p_side, Vec3 q, int q_side, const std::array<Vec3, 3>& t) {
  if (p_side * q_side > 0 || apart(p, q, t)) return false;
  if (p_side == 0 && q_side == 0) return meets_in_plane(projection_axis(t), p, q, t);
  // The line meets the plane in one point, of the segment; it is in the triangle if the line passes all edges
  // on the same side.
  const int ab = orientation_3d(p, q, t[0], t[1]), bc = orientation_3d(p, q, t[1], t[2]);
  if (ab * bc < 0) return false;
  const int ca = orientation_3d(p, q, t[2], t[0]);
  return ab * ca >= 0 && bc * ca >= 0;
}

/// Whether an edge of `a` meets `b`. `sides`: of the plane of b, for the corners of a.
bool edges_meet(const std::array<Vec3, 3>& a, const std::array<int, 3>& sides, const std::array<Vec3, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (segment_meets(a[k], sides[k], a[(k + 1) % 3], sides[(k + 1) % 3], b)) return true;
  return false;
}

/// False if all corners are strictly on the same side.
bool spans(const std::array<int, 3>& sides) {
  return sides[0] == 0 || sides[1] != sides[0] || sides[2] != sides[0];
}

}  // namespace

bool collinear(Vec3 a, Vec3 b, Vec3 c) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (orientation_along(axis, a, b, c) != 0) return false;
  return true;
}

bool is_on_triangle(Vec3 p, const std::array<Vec3, 3>& triangle) {
  return side(triangle, p) == 0 && inside_in_plane(projection_axis(triangle), p, triangle);
}

bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  // Corners in the order: shared ones first, at the same places of p and q.
  std::array<Vec3, 3> p = a, q = b;
  std::size_t shared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto same = std::find(q.begin() + std::ptrdiff_t(shared), q.end(), p[k]);
    if (same == q.end()) continue;
    std::swap(q[shared], *same);
    std::swap(p[shared++], p[k]);
  }
  if (shared == 3) return false;
  if (shared == 2) {
    // Two planes meet in the line of the edge; in one plane both triangles may be on one side of it.
    if (side(p, q[2]) != 0) return false;
    const std::size_t axis = projection_axis(p);
    return orientation_along(axis, p[0], p[1], p[2]) == orientation_along(axis, p[0], p[1], q[2]);
  }
  if (shared == 1) {
    // What is common is convex and holds the vertex. If there is more, following it away from the vertex
    // leads out of a triangle through the edge opposite.
    if (apart(p[1], p[2], q) && apart(q[1], q[2], p)) return false;
    const int p1 = side(q, p[1]), p2 = side(q, p[2]);
    if (p1 * p2 > 0) return false;  // all of p but the vertex is off the plane of q
    const int q1 = side(p, q[1]), q2 = side(p, q[2]);
    if (q1 * q2 > 0) return false;
    return segment_meets(p[1], p1, p[2], p2, q) || segment_meets(q[1], q1, q[2], q2, p);
  }
  const std::array<int, 3> of_q{side(p, q[0]), side(p, q[1]), side(p, q[2])};
  if (!spans(of_q)) return false;
  const std::array<int, 3> of_p{side(q, p[0]), side(q, p[1]), side(q, p[2])};
  return spans(of_p) && (edges_meet(p, of_p, q) || edges_meet(q, of_q, p));
}

}  // namespace mesocell
