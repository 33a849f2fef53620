#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "format/api.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// Squared distance of a point from a closed box, 0 inside. Never above the squared distance that is computed
/// from any point of the box, since rounding keeps the order of differences, squares and sums.
[[nodiscard]] inline double squared_distance(const Box3& box, Vec3 q) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = q[a] < box.min[a] ? box.min[a] - q[a] : q[a] > box.max[a] ? q[a] - box.max[a] : 0.0;
    sum += d * d;
  }
  return sum;
}

/// Whether two closed boxes have a point in common.
[[nodiscard]] inline bool overlap(const Box3& a, const Box3& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
         a.min.z <= b.max.z && b.min.z <= a.max.z;
}

/// A bounding volume hierarchy over boxes, for nearest and for overlapping items. Split by the surface area
/// heuristic over bins [Wald 2007]; at most 4 boxes a leaf. The tree does not depend on the number of
/// threads. Thread safety: const and reentrant.
class BoxTree {
 public:
  /// Over nothing.
  BoxTree() = default;
  /// `boxes`: none empty, all finite, below 2^31 of them; items are named by their places in it. They need
  /// not live on. `threads`: 0 for the machine's.
  explicit BoxTree(std::span<const Box3> boxes, unsigned threads = 0);

  /// Calls `visit(place, limit)`, about nearest first, for the items of all leaves whose boxes are no farther
  /// from `q` than `limit`, a squared distance; `visit` returns the limit to go on with, which may not rise.
  /// The final limit is returned. `place` counts the items in the tree's order: see order(). No allocation.
  template <class Visit>
  double visit_near(Vec3 q, double limit, Visit&& visit) const;

  /// Calls `visit(place)` for the items of all leaves whose boxes have a point in common with `box`, until it
  /// returns false. No allocation.
  template <class Visit>
  void visit_overlapping(const Box3& box, Visit&& visit) const;

  /// For each place the item there. Data laid out in this order is read in runs.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  /// Around all items; empty if there are none.
  [[nodiscard]] Box3 box() const { return nodes_.empty() ? Box3{} : nodes_[0].box; }

 private:
  friend class BoxTreeBuilder;

  struct Node {
    Box3 box;
    /// Of a leaf the first place, else the first of two children that lie side by side.
    std::uint32_t first = 0;
    std::uint32_t count = 0;  ///< places of a leaf; 0: not a leaf
  };
  /// Beyond kMostBinned levels ranges are halved, so with below 2^31 items no path is longer than this.
  static constexpr std::uint32_t kMostBinned = 64, kMostLevels = kMostBinned + 32;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <class Visit>
double BoxTree::visit_near(Vec3 q, double limit, Visit&& visit) const {
  struct Waiting {
    std::uint32_t node;
    double distance;
  };
  std::array<Waiting, kMostLevels> stack;
  std::size_t size = 0;
  if (nodes_.empty()) return limit;
  stack[size++] = {0, squared_distance(nodes_[0].box, q)};
  while (size > 0) {
    Waiting at = stack[--size];
    while (at.distance <= limit && nodes_[at.node].count == 0) {
      const std::uint32_t child = nodes_[at.node].first;
      Waiting near{child, squared_distance(nodes_[child].box, q)};
      Waiting far{child + 1, squared_distance(nodes_[child + 1].box, q)};
      if (far.distance < near.distance) std::swap(near, far);
      if (far.distance <= limit) stack[size++] = far;
      at = near;
    }
    if (at.distance > limit) continue;
    const Node& leaf = nodes_[at.node];
    for (std::uint32_t k = 0; k < leaf.count; ++k) limit = visit(leaf.first + k, limit);
  }
  return limit;
}

template <class Visit>
void BoxTree::visit_overlapping(const Box3& box, Visit&& visit) const {
  std::array<std::uint32_t, kMostLevels> stack;
  std::size_t size = 0;
  if (!nodes_.empty() && overlap(nodes_[0].box, box)) stack[size++] = 0;
  while (size > 0) {
    const Node* at = &nodes_[stack[--size]];
    while (at && at->count == 0) {
      const Node *left = &nodes_[at->first], *right = left + 1;
      if (!overlap(left->box, box)) left = nullptr;
      if (overlap(right->box, box)) {
        if (left)
          stack[size++] = at->first + 1;
        else
          left = right;
      }
      at = left;
    }
    if (!at) continue;
    for (std::uint32_t k = 0; k < at->count; ++k)
      if (!visit(at->first + k)) return;
  }
}

}  // namespace mesocell
