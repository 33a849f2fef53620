#include "sdk/membership/mesh_topology.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace mesocell {

std::vector<Triangle> merge_corners(const TriangleMesh& mesh) {
  // Coordinates that are not finite would break the order that merging sorts by; readers refuse them.
  const std::vector<std::uint32_t> merged = merge_identical_vertices(mesh.vertices);
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) triangles.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
  return triangles;
}

EdgeTable::EdgeTable(std::span<const Triangle> triangles) {
  // Counted into buckets by the lesser vertex, which are small; in the order of the triangles, which stays.
  std::vector<std::size_t> ends;
  const auto for_uses = [&](auto visit) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (has_repeated_vertex(triangles[t])) continue;
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t p = triangles[t][e], q = triangles[t][(e + 1) % 3];
        visit(EdgeUse{std::min(p, q), std::max(p, q), t, p < q ? 1 : -1});
      }
    }
  };
  std::uint32_t last = 0;
  for_uses([&](const EdgeUse& use) { last = std::max(last, use.low); });
  ends.assign(std::size_t{last} + 2, 0);
  for_uses([&](const EdgeUse& use) { ++ends[use.low + 1]; });
  for (std::size_t v = 1; v < ends.size(); ++v) ends[v] += ends[v - 1];
  uses_.resize(ends.back());
  for_uses([&](const EdgeUse& use) { uses_[ends[use.low]++] = use; });
  const auto bucket = [&](std::size_t v) { return uses_.begin() + std::ptrdiff_t(v == 0 ? 0 : ends[v - 1]); };
  for (std::size_t v = 0; v + 1 < ends.size(); ++v)
    std::sort(bucket(v), bucket(v + 1), [](const EdgeUse& a, const EdgeUse& b) {
      return std::tie(a.high, a.triangle) < std::tie(b.high, b.triangle);
    });
  for (std::size_t k = 0; k < uses_.size(); ++k)
    if (k == 0 || uses_[k].low != uses_[k - 1].low || uses_[k].high != uses_[k - 1].high) first_.push_back(k);
  first_.push_back(uses_.size());
}

std::vector<CoincidentTriangles> coincident_triangles(std::span<const Triangle> triangles) {
  struct Key {
    Triangle sorted;
    std::uint32_t triangle;
    std::int8_t sign;  ///< of the permutation that sorted it
  };
  std::vector<Key> keys;
  keys.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (has_repeated_vertex(triangles[t])) continue;
    Key key{triangles[t], t, 1};
    for (const auto& [a, b] : {std::pair{0u, 1u}, {1u, 2u}, {0u, 1u}})
      if (key.sorted[a] > key.sorted[b]) {
        std::swap(key.sorted[a], key.sorted[b]);
        key.sign = std::int8_t(-key.sign);
      }
    keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return std::tie(a.sorted, a.triangle) < std::tie(b.sorted, b.triangle);
  });
  std::vector<CoincidentTriangles> sets;
  for (std::size_t k = 0; k < keys.size();) {
    std::size_t end = k + 1;
    while (end < keys.size() && keys[end].sorted == keys[k].sorted) ++end;
    if (end - k > 1) {
      CoincidentTriangles& set = sets.emplace_back();
      for (std::size_t i = k; i < end; ++i) {
        set.triangles.push_back(keys[i].triangle);
        set.signs.push_back(std::int8_t(keys[i].sign * keys[k].sign));
      }
    }
    k = end;
  }
  std::sort(sets.begin(), sets.end(), [](const CoincidentTriangles& a, const CoincidentTriangles& b) {
    return a.triangles[0] < b.triangles[0];
  });
  return sets;
}

Components edge_components(std::span<const Triangle> triangles, const EdgeTable& edges) {
  DisjointSets sets(triangles.size());
  for (std::size_t e = 0; e < edges.size(); ++e)
    for (const EdgeUse& use : edges[e]) sets.join(edges[e][0].triangle, use.triangle);
  Components components{std::vector<std::uint32_t>(triangles.size(), kNoComponent)};
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (has_repeated_vertex(triangles[t])) continue;
    const std::uint32_t first = sets.find(t);  // never after t
    components.of_triangle[t] = first == t ? components.count++ : components.of_triangle[first];
  }
  return components;
}

}  // namespace mesocell
