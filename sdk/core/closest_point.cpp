#include "sdk/core/closest_point.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>

namespace mesocell {
namespace {

std::vector<Box3> triangle_boxes(const TriangleMesh& mesh) {
  assert(!mesh.triangles.empty());
  std::vector<Box3> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) boxes[t].add(mesh.vertices[v]);
  return boxes;
}

struct Candidate {
  Vec3 point;
  double squared = std::numeric_limits<double>::infinity();
  std::array<double, 3> barycentric{};
};

/// Keeps the nearer of `best` and a point, which is first held to the box of [low, high]: rounding then
/// cannot put it outside the boxes of the tree, whose distances are compared with this one.
void improve(Candidate& best, Vec3 q, Vec3 point, Vec3 low, Vec3 high,
             const std::array<double, 3>& barycentric) {
  point = min(max(point, low), high);
  const Vec3 d = point - q;
  const double squared = dot(d, d);
  if (squared < best.squared) best = {point, squared, barycentric};
}

/// The edge from vertex i to vertex j.
void try_edge(Candidate& best, Vec3 q, const std::array<Vec3, 3>& corners, std::size_t i, std::size_t j) {
  // Triangles that share an edge compute the same, from the same end.
  const Vec3 &u = corners[i], &v = corners[j];
  if (std::tie(v.x, v.y, v.z) < std::tie(u.x, u.y, u.z)) std::swap(i, j);
  const Vec3 &a = corners[i], &b = corners[j];
  const Vec3 along = b - a;
  const double squared = dot(along, along), s = dot(q - a, along);
  std::array<double, 3> barycentric{};
  if (!(s > 0)) {
    barycentric[i] = 1;
    improve(best, q, a, a, a, barycentric);
  } else if (s >= squared) {
    barycentric[j] = 1;
    improve(best, q, b, b, b, barycentric);
  } else {
    const double t = s / squared;
    barycentric[i] = 1 - t;
    barycentric[j] = t;
    improve(best, q, a + along * t, min(a, b), max(a, b), barycentric);
  }
}

/// The point of a triangle that is nearest to `q`.
Candidate nearest_of(const std::array<Vec3, 3>& corners, Vec3 q) {
  const auto& [a, b, c] = corners;
  const Vec3 ab = b - a, ac = c - a, aq = q - a, n = cross(ab, ac);
  const double squared = dot(n, n);
  Candidate best;
  // Shares of the vertices in the foot of the perpendicular.
  std::array<double, 3> shares{-1, -1, -1};
  if (squared > 0) {
    shares[1] = dot(cross(aq, ac), n) / squared;
    shares[2] = dot(cross(ab, aq), n) / squared;
    shares[0] = 1 - shares[1] - shares[2];
    // Of a needle the shares are unsure, but if they are positive the foot is a point of it all the same.
    if (shares[0] >= 0 && shares[1] >= 0 && shares[2] >= 0)
      improve(best, q, a + ab * shares[1] + ac * shares[2], min(min(a, b), c), max(max(a, b), c), shares);
    constexpr double kNeedle = 1e-10;  // the squared sine of its angle at `a`
    if (!(squared > kNeedle * dot(ab, ab) * dot(ac, ac))) shares = {-1, -1, -1};
  }
  // A segment from the point to an edge that its foot is not beyond crosses one that it is beyond first.
  // Shares that overflowed are not numbers.
  constexpr double kUnsure = 1e-6;
  for (std::size_t i = 0; i < 3; ++i)
    if (!(shares[(i + 2) % 3] >= kUnsure)) try_edge(best, q, corners, i, (i + 1) % 3);
  return best;
}

}  // namespace

ClosestPoint::ClosestPoint(const TriangleMesh& mesh, unsigned threads)
    : tree_(triangle_boxes(mesh), threads) {
  triangles_.reserve(mesh.triangles.size());
  for (const std::uint32_t t : tree_.order()) {
    const Triangle& v = mesh.triangles[t];
    triangles_.push_back({mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]});
  }
}

SurfacePoint ClosestPoint::query(Vec3 p) const {
  assert(is_finite(p));
  Candidate best;
  std::uint32_t triangle = 0;
  tree_.visit_near(p, best.squared, [&](std::uint32_t place, double limit) {
    const std::array<Vec3, 3>& corners = triangles_[place];
    const auto& [a, b, c] = corners;
    if (squared_distance({min(min(a, b), c), max(max(a, b), c)}, p) > limit) return limit;
    const Candidate candidate = nearest_of(corners, p);
    const std::uint32_t t = tree_.order()[place];
    if (candidate.squared < limit || (candidate.squared == limit && t < triangle)) {
      best = candidate;
      triangle = t;
    }
    return best.squared;
  });
  return {best.point, std::sqrt(best.squared), triangle, best.barycentric};
}

}  // namespace mesocell
