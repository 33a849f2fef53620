#include "sdk/membership/nesting.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "sdk/core/box_tree.h"
#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

/// Side of p + (ε, ε²) of the line from a to b, seen along z; 0 only if a and b are the same there.
int side_of_line(Vec3 a, Vec3 b, Vec3 p) {
  if (const int s = orientation_2d(a.x, a.y, b.x, b.y, p.x, p.y)) return s;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;
  return b.x > a.x ? 1 : b.x < a.x ? -1 : 0;
}

/// Side of p + (ε, ε², ε³) of the plane through a, b, c, which is not vertical.
int side_of_plane(Vec3 a, Vec3 b, Vec3 c, Vec3 p) {
  if (const int s = orientation_3d(a, b, c, p)) return s;
  // The components of the normal, in the order of the powers of ε.
  if (const int s = orientation_2d(a.y, a.z, b.y, b.z, c.y, c.z)) return s;
  if (const int s = orientation_2d(a.z, a.x, b.z, b.x, c.z, c.x)) return s;
  return orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
}

/// What a triangle adds to the winding number about p + (ε, ε², ε³) by a ray along z.
int crossing(Vec3 a, Vec3 b, Vec3 c, Vec3 p) {
  const int s = orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
  if (s == 0 || side_of_line(a, b, p) != s || side_of_line(b, c, p) != s || side_of_line(c, a, p) != s)
    return 0;
  return side_of_plane(a, b, c, p) * s < 0 ? s : 0;
}

bool within(const Box3& a, const Box3& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.min[k] < b.min[k] || a.max[k] > b.max[k]) return false;
  return true;
}

}  // namespace

std::vector<Shell> measure_shells(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                  std::span<const std::uint32_t> shell_of, std::uint32_t count,
                                  bool nesting) {
  std::vector<Shell> shells(count);
  std::vector<Box3> boxes(count), triangle_boxes;
  std::vector<std::uint32_t> members;  // triangles of shells
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (shell_of[t] == kNoComponent) continue;
    Shell& shell = shells[shell_of[t]];
    Box3& box = boxes[shell_of[t]];
    Box3& own = triangle_boxes.emplace_back();
    members.push_back(t);
    for (const std::uint32_t v : triangles[t]) {
      const Vec3 p = vertices[v];
      if (box.empty() || std::tie(p.x, p.y, p.z) < std::tie(shell.lowest.x, shell.lowest.y, shell.lowest.z))
        shell.lowest = p;
      box.add(p);
      own.add(p);
    }
  }
  for (const std::uint32_t t : members) {
    const Box3& box = boxes[shell_of[t]];
    const Vec3 centre = box.min + box.extent() * 0.5;
    const Vec3 a = vertices[triangles[t][0]], b = vertices[triangles[t][1]], c = vertices[triangles[t][2]];
    shells[shell_of[t]].volume += dot(a - centre, cross(b - centre, c - centre)) / 6;
  }
  if (!nesting || count < 2) return shells;

  const BoxTree shell_tree(boxes), triangle_tree(triangle_boxes);
  std::vector<std::pair<std::uint32_t, int>> crossings;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto may_contain = [&](std::uint32_t other) {
      return other != k && within(boxes[k], boxes[other]) && (other < k || !within(boxes[other], boxes[k]));
    };
    bool any = false;
    shell_tree.visit_overlapping(boxes[k], [&](std::uint32_t place) {
      any = any || may_contain(shell_tree.order()[place]);
      return !any;
    });
    if (!any) continue;
    Shell& shell = shells[k];
    Box3 ray;
    ray.add(shell.lowest);
    ray.max.z = std::numeric_limits<double>::infinity();
    crossings.clear();
    triangle_tree.visit_overlapping(ray, [&](std::uint32_t place) {
      const std::uint32_t t = members[triangle_tree.order()[place]];
      const Triangle& v = triangles[t];
      if (may_contain(shell_of[t]))
        if (const int s = crossing(vertices[v[0]], vertices[v[1]], vertices[v[2]], shell.lowest))
          crossings.emplace_back(shell_of[t], s);
      return true;
    });
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i < crossings.size();) {
      const std::uint32_t other = crossings[i].first;
      std::int64_t winding = 0;
      for (; i < crossings.size() && crossings[i].first == other; ++i) winding += crossings[i].second;
      if (winding == 0) continue;
      if (shell.containers++ == 0) shell.container = other;
      shell.winding += winding;
    }
  }
  return shells;
}

}  // namespace mesocell
