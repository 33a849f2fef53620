#include "sdk/membership/nesting.h"

#include <algorithm>
#include <array>
#include <compare>
#include <limits>
#include <tuple>
#include <utility>

#include "sdk/core/box_tree.h"
#include "sdk/membership/crossing.h"
#include "sdk/membership/triangle_triangle.h"

namespace mesocell {
namespace {

bool within(const Box3& a, const Box3& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.min[k] < b.min[k] || a.max[k] > b.max[k]) return false;
  return true;
}

bool holds(const Box3& box, Vec3 p) {
  Box3 point;
  point.add(p);
  return overlap(box, point);
}

class Nesting {
 public:
  Nesting(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
          std::span<const std::uint32_t> shell_of, std::vector<Shell>& shells, std::span<const Box3> boxes)
      : vertices_(vertices),
        triangles_(triangles),
        shell_of_(shell_of),
        shells_(shells),
        boxes_(boxes),
        members_(in_shells(shell_of)),
        triangle_boxes_(boxes_of(vertices, triangles, members_)),
        shell_tree_(boxes),
        triangle_tree_(triangle_boxes_) {}

  void run() {
    // The triangles of each shell, in their order.
    std::vector<std::uint32_t> by_shell = members_;
    std::stable_sort(by_shell.begin(), by_shell.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return shell_of_[a] < shell_of_[b]; });
    for (std::size_t k = 0; k < by_shell.size();) {
      std::size_t end = k;
      while (end < by_shell.size() && shell_of_[by_shell[end]] == shell_of_[by_shell[k]]) ++end;
      find_containers(shell_of_[by_shell[k]], std::span(by_shell).subspan(k, end - k));
      k = end;
    }
  }

 private:
  static constexpr std::size_t kProbes = 32;
  /// Shells in shells in shells take time by the square of their number.
  static constexpr std::uint64_t kMostLooks = std::uint64_t{1} << 24;

  struct Container {
    std::uint32_t shell;
    std::int64_t winding;  ///< 0: the probes were on it so far
    auto operator<=>(const Container&) const = default;
  };

  static std::vector<std::uint32_t> in_shells(std::span<const std::uint32_t> shell_of) {
    std::vector<std::uint32_t> members;
    for (std::uint32_t t = 0; t < shell_of.size(); ++t)
      if (shell_of[t] != kNoComponent) members.push_back(t);
    return members;
  }

  static std::vector<Box3> boxes_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                    std::span<const std::uint32_t> members) {
    std::vector<Box3> boxes(members.size());
    for (std::size_t k = 0; k < members.size(); ++k)
      for (const std::uint32_t v : triangles[members[k]]) boxes[k].add(vertices[v]);
    return boxes;
  }

  [[nodiscard]] bool may_contain(std::uint32_t other, std::uint32_t shell) const {
    return other != shell && within(boxes_[shell], boxes_[other]) &&
           (other < shell || !within(boxes_[other], boxes_[shell]));
  }

  void find_containers(std::uint32_t shell, std::span<const std::uint32_t> own) {
    if (looks_ >= kMostLooks) return;
    bool any = false;
    shell_tree_.visit_overlapping(boxes_[shell], [&](std::uint32_t place) {
      any = may_contain(shell_tree_.order()[place], shell);
      return !any;
    });
    if (!any) return;
    const std::size_t probes = looks_ < kMostLooks / 2 ? std::min(kProbes, 3 * own.size()) : 0;
    std::vector<Container> containers = around(shells_[shell].lowest, shell);
    for (std::size_t k = 0; k < probes && !containers.empty(); ++k) {
      const std::size_t corner = k * 3 * own.size() / probes;
      const std::vector<Container> here = around(vertices_[triangles_[own[corner / 3]][corner % 3]], shell);
      std::erase_if(containers, [&](Container& c) {
        const auto same = std::lower_bound(here.begin(), here.end(), c.shell,
                                           [](const Container& a, std::uint32_t b) { return a.shell < b; });
        if (same == here.end() || same->shell != c.shell) return true;
        if (c.winding == 0) c.winding = same->winding;
        return false;
      });
    }
    for (const Container& c : containers) {
      if (c.winding == 0) continue;
      if (shells_[shell].containers++ == 0) shells_[shell].container = c.shell;
      shells_[shell].winding += c.winding;
    }
  }

  /// The shells that may contain `shell` and that p is in or on, in their order.
  [[nodiscard]] std::vector<Container> around(Vec3 p, std::uint32_t shell) {
    std::vector<Container> found;
    Box3 ray;
    ray.add(p);
    ray.min.x = -std::numeric_limits<double>::infinity();
    triangle_tree_.visit_overlapping(ray, [&](std::uint32_t place) {
      ++looks_;
      const std::uint32_t k = triangle_tree_.order()[place], t = members_[k];
      if (!may_contain(shell_of_[t], shell)) return true;
      const Triangle& v = triangles_[t];
      const std::array<Vec3, 3> corners{vertices_[v[0]], vertices_[v[1]], vertices_[v[2]]};
      if (const int s = crossing(corners, p)) found.push_back({shell_of_[t], s});
      if (holds(triangle_boxes_[k], p) && !collinear(corners[0], corners[1], corners[2]) &&
          is_on_triangle(p, corners))
        found.push_back({shell_of_[t], 0});
      return true;
    });
    // One for each shell: its winding number, or 0 if p is on it.
    std::sort(found.begin(), found.end());
    std::vector<Container> sums;
    for (std::size_t k = 0; k < found.size();) {
      Container sum{found[k].shell, 0};
      bool on = false;
      for (; k < found.size() && found[k].shell == sum.shell; ++k) {
        sum.winding += found[k].winding;
        on = on || found[k].winding == 0;
      }
      if (on) sum.winding = 0;
      if (on || sum.winding != 0) sums.push_back(sum);
    }
    return sums;
  }

  std::span<const Vec3> vertices_;
  std::span<const Triangle> triangles_;
  std::span<const std::uint32_t> shell_of_;
  std::vector<Shell>& shells_;
  std::span<const Box3> boxes_;
  std::vector<std::uint32_t> members_;  ///< the triangles of shells
  std::vector<Box3> triangle_boxes_;    ///< theirs
  BoxTree shell_tree_, triangle_tree_;
  std::uint64_t looks_ = 0;  ///< at triangles above probes
};

}  // namespace

std::vector<Shell> measure_shells(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                  std::span<const std::uint32_t> shell_of, std::uint32_t count,
                                  bool nesting) {
  std::vector<Shell> shells(count);
  std::vector<Box3> boxes(count);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (shell_of[t] == kNoComponent) continue;
    Shell& shell = shells[shell_of[t]];
    for (const std::uint32_t v : triangles[t]) {
      const Vec3 p = vertices[v], &q = shell.lowest;
      if (boxes[shell_of[t]].empty() || std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z)) shell.lowest = p;
      boxes[shell_of[t]].add(p);
    }
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (shell_of[t] == kNoComponent) continue;
    const Box3& box = boxes[shell_of[t]];
    const Vec3 centre = box.min + box.extent() * 0.5;
    const Vec3 a = vertices[triangles[t][0]], b = vertices[triangles[t][1]], c = vertices[triangles[t][2]];
    shells[shell_of[t]].volume += dot(a - centre, cross(b - centre, c - centre)) / 6;
  }
  if (nesting && count > 1) Nesting(vertices, triangles, shell_of, shells, boxes).run();
  return shells;
}

}  // namespace mesocell
