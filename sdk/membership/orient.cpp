#include "sdk/membership/orient.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "sdk/membership/mesh_topology.h"
#include "sdk/membership/nesting.h"

namespace mesocell {
namespace {

/// Decides which of the triangles with the same three vertices stay.
class DuplicateFilter {
 public:
  DuplicateFilter(std::span<const Triangle> triangles, std::vector<bool>& keep, OrientedMesh& out)
      : triangles_(triangles), keep_(keep), out_(out), sets_(coincident_triangles(triangles)) {}

  void run() {
    if (sets_.empty()) return;
    const EdgeTable edges(triangles_);
    const Components components = edge_components(triangles_, edges);
    std::vector<bool> closed(components.count, true), remains(components.count, false);
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (balance(edges[e]) != 0) closed[components.of_triangle[edges[e][0].triangle]] = false;
    std::vector<bool> in_set(triangles_.size(), false);
    for (const CoincidentTriangles& set : sets_) {
      for (const std::uint32_t t : set.triangles) in_set[t] = true;
      if (sum(set) != 0) remains[components.of_triangle[set.triangles[0]]] = true;
    }
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      if (!in_set[t] && components.of_triangle[t] != kNoComponent) remains[components.of_triangle[t]] = true;

    std::vector<std::uint32_t> undecided;
    for (std::uint32_t s = 0; s < sets_.size(); ++s) {
      const std::uint32_t component = components.of_triangle[sets_[s].triangles[0]];
      if (closed[component] && remains[component])
        keep_of(sets_[s], std::size_t(std::abs(sum(sets_[s]))));
      else if (closed[component] || sets_[s].triangles.size() % 2 != 0)
        keep_of(sets_[s], 1);
      else
        undecided.push_back(s);
    }
    if (!undecided.empty()) decide_by_parity(undecided);
  }

 private:
  static std::int64_t sum(const CoincidentTriangles& set) {
    std::int64_t sum = 0;
    for (const std::int8_t sign : set.signs) sum += sign;
    return sum;
  }

  /// Keeps the first `count` of those that have the sign of the sum.
  void keep_of(const CoincidentTriangles& set, std::size_t count) {
    const std::int8_t sign = sum(set) < 0 ? std::int8_t{-1} : std::int8_t{1};
    (count > 0 ? out_.duplicates_dropped : out_.cancelled) += set.triangles.size() - count;
    for (std::size_t k = 0; k < set.triangles.size(); ++k) {
      const bool kept = count > 0 && set.signs[k] == sign;
      keep_[set.triangles[k]] = kept;
      if (kept) --count;
    }
  }

  void decide_by_parity(std::span<const std::uint32_t> undecided) {
    // One triangle for each set, and those that stand alone or are decided.
    constexpr std::uint32_t kAlone = 0xffff'ffff;
    std::vector<std::uint32_t> set_of(triangles_.size(), kAlone);
    std::vector<bool> stands = keep_;
    for (const std::uint32_t s : undecided) {
      for (const std::uint32_t t : sets_[s].triangles) stands[t] = false;
      stands[sets_[s].triangles[0]] = true;
      set_of[sets_[s].triangles[0]] = s;
    }
    std::vector<Triangle> standing(triangles_.begin(), triangles_.end());
    for (std::size_t t = 0; t < standing.size(); ++t)
      if (!stands[t]) standing[t] = {0, 0, 0};
    const EdgeTable edges(standing);

    DisjointSets groups(sets_.size());
    const auto first_set = [&](std::span<const EdgeUse> uses) {
      const auto use = std::find_if(uses.begin(), uses.end(),
                                    [&](const EdgeUse& u) { return set_of[u.triangle] != kAlone; });
      return use == uses.end() ? kAlone : set_of[use->triangle];
    };
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (const std::uint32_t first = first_set(edges[e]); first != kAlone)
        for (const EdgeUse& use : edges[e])
          if (set_of[use.triangle] != kAlone) groups.join(first, set_of[use.triangle]);

    struct Cost {
      std::uint64_t kept = 0, dropped = 0;  ///< edges with an odd number of triangles
      bool attached = false;                ///< to triangles that stay in any case
    };
    std::vector<Cost> costs(sets_.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const std::uint32_t first = first_set(edges[e]);
      if (first == kAlone) continue;
      Cost& cost = costs[groups.find(first)];
      const auto alone = std::count_if(edges[e].begin(), edges[e].end(),
                                       [&](const EdgeUse& u) { return set_of[u.triangle] == kAlone; });
      cost.kept += edges[e].size() % 2;
      cost.dropped += std::uint64_t(alone) % 2;
      cost.attached = cost.attached || alone > 0;
    }
    for (const std::uint32_t s : undecided) {
      const Cost& cost = costs[groups.find(s)];
      keep_of(sets_[s], cost.attached && cost.dropped < cost.kept ? 0 : 1);
    }
  }

  std::span<const Triangle> triangles_;
  std::vector<bool>& keep_;
  OrientedMesh& out_;
  std::vector<CoincidentTriangles> sets_;
};

/// Patches of triangles that hang together by edges of exactly two triangles, and how to turn them.
class PatchOrienter {
 public:
  PatchOrienter(std::span<const Vec3> vertices, std::span<const Triangle> triangles)
      : vertices_(vertices), triangles_(triangles), edges_(triangles), turned_(triangles.size(), 0) {}

  void run(OrientedMesh& out) {
    spread(out);
    turn_inside_out_parts();
    out.components = edge_components(triangles_, edges_).count;
    out.patches = patches_;
    out.closed = !triangles_.empty();
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      std::int64_t sum = 0;
      for (const EdgeUse& use : edges_[e]) sum += direction(use);
      if (sum != 0) out.closed = false;
    }
  }

  [[nodiscard]] bool turned(std::size_t triangle) const { return turned_[triangle] != 0; }

 private:
  [[nodiscard]] std::int32_t direction(const EdgeUse& use) const {
    return turned_[use.triangle] ? -use.direction : use.direction;
  }

  /// Makes every patch consistent in itself, from its first triangle on.
  void spread(OrientedMesh& out) {
    struct Neighbour {
      std::uint32_t triangle;
      bool differs;  ///< runs along the common edge in the same direction
    };
    std::vector<std::array<Neighbour, 3>> neighbours(triangles_.size());
    std::vector<std::uint8_t> degree(triangles_.size(), 0);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (edges_[e].size() != 2) continue;
      const EdgeUse &a = edges_[e][0], &b = edges_[e][1];
      const bool differs = a.direction == b.direction;
      neighbours[a.triangle][degree[a.triangle]++] = {b.triangle, differs};
      neighbours[b.triangle][degree[b.triangle]++] = {a.triangle, differs};
    }
    patch_of_.assign(triangles_.size(), kNoComponent);
    std::vector<std::uint32_t> members;
    for (std::uint32_t first = 0; first < triangles_.size(); ++first) {
      if (patch_of_[first] != kNoComponent) continue;
      const std::uint32_t patch = patches_++;
      members.assign(1, first);
      patch_of_[first] = patch;
      bool orientable = true;
      std::size_t turned = 0;
      for (std::size_t k = 0; k < members.size(); ++k) {
        const std::uint32_t t = members[k];
        turned += turned_[t];
        for (std::uint8_t n = 0; n < degree[t]; ++n) {
          const Neighbour& other = neighbours[t][n];
          const std::uint8_t turn = turned_[t] ^ std::uint8_t(other.differs);
          if (patch_of_[other.triangle] == kNoComponent) {
            patch_of_[other.triangle] = patch;
            turned_[other.triangle] = turn;
            members.push_back(other.triangle);
          } else if (turned_[other.triangle] != turn) {
            orientable = false;
          }
        }
      }
      if (!orientable) {
        for (const std::uint32_t t : members) turned_[t] = 0;
        if (out.non_orientable++ == 0) out.non_orientable_example = vertices_[triangles_[first][0]];
      } else if (turned > members.size() - turned) {
        for (const std::uint32_t t : members) turned_[t] ^= 1;
      }
    }
  }

  /// For every triangle the closed part it belongs to: a patch closed in itself, or other patches that are
  /// closed together.
  [[nodiscard]] Components closed_parts() const {
    std::vector<bool> closed(patches_, true);
    std::vector<std::pair<std::uint32_t, std::int64_t>> sums;  // of the patches at an edge
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      sums.clear();
      for (const EdgeUse& use : edges_[e]) sums.emplace_back(patch_of_[use.triangle], direction(use));
      std::sort(sums.begin(), sums.end());
      for (std::size_t k = 0; k < sums.size();) {
        const std::uint32_t patch = sums[k].first;
        std::int64_t sum = 0;
        for (; k < sums.size() && sums[k].first == patch; ++k) sum += sums[k].second;
        if (sum != 0) closed[patch] = false;
      }
    }
    DisjointSets parts(patches_);
    std::vector<bool> open(patches_,
                           false);  // by the part's first patch, of patches not closed in themselves
    const auto for_open_uses = [&](std::size_t e, auto f) {
      for (const EdgeUse& use : edges_[e])
        if (!closed[patch_of_[use.triangle]]) f(use);
    };
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      std::uint32_t first = kNoComponent;
      for_open_uses(e, [&](const EdgeUse& use) {
        if (first == kNoComponent) first = patch_of_[use.triangle];
        parts.join(first, patch_of_[use.triangle]);
      });
    }
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      std::int64_t sum = 0;
      std::uint32_t patch = kNoComponent;
      for_open_uses(e, [&](const EdgeUse& use) {
        sum += direction(use);
        patch = patch_of_[use.triangle];
      });
      if (sum != 0) open[parts.find(patch)] = true;
    }
    Components result{std::vector<std::uint32_t>(triangles_.size(), kNoComponent)};
    std::vector<std::uint32_t> number(patches_, kNoComponent);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const std::uint32_t part = parts.find(patch_of_[t]);
      if (open[part]) continue;
      if (number[part] == kNoComponent) number[part] = result.count++;
      result.of_triangle[t] = number[part];
    }
    return result;
  }

  void turn_inside_out_parts() {
    const Components parts = closed_parts();
    std::vector<Triangle> now(triangles_.begin(), triangles_.end());
    for (std::size_t t = 0; t < now.size(); ++t)
      if (turned_[t]) std::swap(now[t][1], now[t][2]);
    const std::vector<Shell> shells = measure_shells(vertices_, now, parts.of_triangle, parts.count);
    const auto outermost = [&](std::uint32_t shell) {
      while (shells[shell].containers > 0) shell = shells[shell].container;
      return shell;
    };
    std::vector<std::uint8_t> turn(parts.count);
    for (std::uint32_t s = 0; s < parts.count; ++s) turn[s] = shells[outermost(s)].volume < 0 ? 1 : 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (parts.of_triangle[t] != kNoComponent) turned_[t] ^= turn[parts.of_triangle[t]];
  }

  std::span<const Vec3> vertices_;
  std::span<const Triangle> triangles_;
  EdgeTable edges_;
  std::vector<std::uint8_t> turned_;
  std::vector<std::uint32_t> patch_of_;
  std::uint32_t patches_ = 0;
};

}  // namespace

OrientedMesh orient(const TriangleMesh& mesh, const Progress* progress) {
  const auto stopped = [&](std::string_view stage, double fraction) {
    if (progress && progress->report) progress->report(stage, fraction);
    return progress && progress->cancelled();
  };
  OrientedMesh interrupted;
  interrupted.interrupted = true;
  constexpr std::string_view kStage = "orient";
  if (stopped(kStage, 0)) return interrupted;
  OrientedMesh out;
  out.mesh.vertices = mesh.vertices;
  out.mesh.colors = mesh.colors;
  const std::vector<Triangle> merged = merge_corners(mesh);
  std::vector<bool> keep(merged.size());
  for (std::size_t t = 0; t < merged.size(); ++t) keep[t] = !has_repeated_vertex(merged[t]);
  out.degenerate_dropped = std::uint64_t(std::count(keep.begin(), keep.end(), false));
  DuplicateFilter(merged, keep, out).run();
  if (stopped(kStage, 0.3)) return interrupted;

  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < merged.size(); ++t) {
    if (!keep[t]) continue;
    triangles.push_back(merged[t]);
    out.mesh.triangles.push_back(mesh.triangles[t]);
  }
  PatchOrienter orienter(mesh.vertices, triangles);
  orienter.run(out);
  if (stopped(kStage, 1)) return interrupted;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!orienter.turned(t)) continue;
    ++out.turned;
    std::swap(out.mesh.triangles[t][1], out.mesh.triangles[t][2]);
  }
  return out;
}

}  // namespace mesocell
