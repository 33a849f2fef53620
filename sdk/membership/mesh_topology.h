#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "sdk/core/triangle_mesh.h"

/// What hangs together with what in a triangle soup, by sorting. Nothing here looks at coordinates.
namespace mesocell {

[[nodiscard]] inline bool has_repeated_vertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// The triangles with every vertex replaced by the one that stands for all at its place.
[[nodiscard]] std::vector<Triangle> merge_corners(const TriangleMesh& mesh);

/// One triangle's way along an edge.
struct EdgeUse {
  std::uint32_t low, high;  ///< the edge's vertices, low < high
  std::uint32_t triangle;
  std::int32_t direction;  ///< +1 from low to high, -1 back
};

/// The edges of triangles, in the order of their vertices, each with the triangles that use it.
class EdgeTable {
 public:
  /// Triangles with a repeated vertex are left out.
  explicit EdgeTable(std::span<const Triangle> triangles);

  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
  /// In the order of the triangles.
  [[nodiscard]] std::span<const EdgeUse> operator[](std::size_t edge) const {
    return std::span(uses_).subspan(first_[edge], first_[edge + 1] - first_[edge]);
  }

 private:
  std::vector<EdgeUse> uses_;
  std::vector<std::size_t> first_;
};

/// How much oftener the uses run from low to high than back.
[[nodiscard]] inline std::int64_t balance(std::span<const EdgeUse> uses) {
  std::int64_t sum = 0;
  for (const EdgeUse& use : uses) sum += use.direction;
  return sum;
}

/// Triangles with the same three vertices.
struct CoincidentTriangles {
  std::vector<std::uint32_t> triangles;  ///< ascending
  std::vector<std::int8_t> signs;        ///< +1: oriented as the first of them, -1: the other way
};

/// The sets of two triangles or more that have the same vertices, in the order of their first triangles.
/// Triangles with a repeated vertex are in none.
[[nodiscard]] std::vector<CoincidentTriangles> coincident_triangles(std::span<const Triangle> triangles);

/// Disjoint sets [Tarjan 1975], with path halving; a set is named by its least member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t find(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a < b)
      parent_[b] = a;
    else
      parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

inline constexpr std::uint32_t kNoComponent = 0xffff'ffff;

/// Parts of a soup that hang together by edges, however many triangles an edge has.
struct Components {
  std::vector<std::uint32_t> of_triangle;  ///< kNoComponent for triangles with a repeated vertex
  std::uint32_t count = 0;                 ///< numbered in the order of their first triangles
};

[[nodiscard]] Components edge_components(std::span<const Triangle> triangles, const EdgeTable& edges);

}  // namespace mesocell
