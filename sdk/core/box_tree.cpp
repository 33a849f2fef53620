#include "sdk/core/box_tree.h"

#include <algorithm>
#include <cassert>

#include "sdk/core/parallel.h"

namespace mesocell {

/// Builds in two steps: the top of the tree in one thread, down to ranges of a size that depends on the
/// number of items alone; then the ranges' trees side by side.
class BoxTreeBuilder {
 public:
  BoxTreeBuilder(std::span<const Box3> boxes, unsigned threads) : threads_(threads) {
    items_.reserve(boxes.size());
    for (const Box3& box : boxes) items_.push_back({box, std::uint32_t(items_.size())});
  }

  void build(BoxTree& tree) {
    if (items_.empty()) return;
    const std::uint32_t count = std::uint32_t(items_.size());
    std::vector<Range> tasks;
    tree.nodes_.emplace_back();
    split_all({0, count, 0, 0}, std::max(count / 64, 4096u), tree.nodes_, &tasks);
    std::vector<std::vector<Node>> parts(tasks.size());
    parallel_for(tasks.size(), threads_, [&](std::size_t k, unsigned) {
      parts[k].emplace_back();
      split_all({tasks[k].first, tasks[k].count, 0, tasks[k].level}, 0, parts[k], nullptr);
    });
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      // A part's root takes the place that is kept for it, so the others move by one less.
      const std::uint32_t move = std::uint32_t(tree.nodes_.size()) - 1;
      for (Node& node : parts[k])
        if (node.count == 0) node.first += move;
      tree.nodes_[tasks[k].node] = parts[k][0];
      tree.nodes_.insert(tree.nodes_.end(), parts[k].begin() + 1, parts[k].end());
    }
    tree.order_.reserve(items_.size());
    for (const Item& item : items_) tree.order_.push_back(item.id);
  }

 private:
  using Node = BoxTree::Node;

  struct Item {
    Box3 box;
    std::uint32_t id;
    /// Twice the centre.
    [[nodiscard]] double centre(std::size_t axis) const { return box.min[axis] + box.max[axis]; }
  };
  struct Range {
    std::uint32_t first, count, node, level;
  };
  static constexpr std::uint32_t kLeaf = 4, kBins = 16;

  /// Fills nodes[range.node] and what is below it. Ranges of up to `grain` items are left to `tasks`, if
  /// given.
  void split_all(Range root, std::uint32_t grain, std::vector<Node>& nodes, std::vector<Range>* tasks) {
    std::vector<Range> stack = {root};
    while (!stack.empty()) {
      const Range range = stack.back();
      stack.pop_back();
      if (tasks && range.count <= grain) {
        tasks->push_back(range);
        continue;
      }
      Box3 box, centres;
      for (const Item& item : std::span(items_).subspan(range.first, range.count)) {
        box.min = min(box.min, item.box.min);
        box.max = max(box.max, item.box.max);
        centres.add({item.centre(0), item.centre(1), item.centre(2)});
      }
      nodes[range.node].box = box;
      if (range.count <= kLeaf) {
        nodes[range.node].first = range.first;
        nodes[range.node].count = range.count;
        continue;
      }
      const std::uint32_t left = split(range, centres), child = std::uint32_t(nodes.size());
      nodes[range.node].first = child;
      nodes.resize(nodes.size() + 2);
      stack.push_back({range.first, left, child, range.level + 1});
      stack.push_back({range.first + left, range.count - left, child + 1, range.level + 1});
    }
  }

  static double half_area(const Box3& box) {
    const Vec3 e = box.extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }

  /// Parts the items of a range in two, neither empty; the number in the first.
  std::uint32_t split(const Range& range, const Box3& centres) {
    const auto begin = items_.begin() + range.first, end = begin + range.count;
    const Vec3 extent = centres.extent();
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (extent[a] > extent[axis]) axis = a;
    const double low = centres.min[axis], scale = kBins / extent[axis];
    if (range.level < BoxTree::kMostBinned && std::isfinite(extent[axis]) && std::isfinite(scale)) {
      const auto bin = [&](const Item& item) {
        return std::min(std::uint32_t((item.centre(axis) - low) * scale), kBins - 1);
      };
      std::array<Box3, kBins> boxes;
      std::array<std::uint32_t, kBins> counts{};
      for (auto i = begin; i != end; ++i) {
        const std::uint32_t b = bin(*i);
        boxes[b].min = min(boxes[b].min, i->box.min);
        boxes[b].max = max(boxes[b].max, i->box.max);
        ++counts[b];
      }
      const std::uint32_t cut = best_cut(boxes, counts);
      return std::uint32_t(std::partition(begin, end, [&](const Item& i) { return bin(i) < cut; }) - begin);
    }
    // All centres coincide, or the tree is deep.
    const std::uint32_t half = range.count / 2;
    std::nth_element(begin, begin + half, end, [&](const Item& a, const Item& b) {
      return a.centre(axis) != b.centre(axis) ? a.centre(axis) < b.centre(axis) : a.id < b.id;
    });
    return half;
  }

  /// The bin that begins the second part. The first and the last bin are not empty.
  static std::uint32_t best_cut(const std::array<Box3, kBins>& boxes,
                                const std::array<std::uint32_t, kBins>& counts) {
    const auto add = [](Box3& sum, const Box3& box) {
      sum.min = min(sum.min, box.min);
      sum.max = max(sum.max, box.max);
    };
    std::array<double, kBins> after{};
    Box3 box;
    std::uint32_t count = 0;
    for (std::uint32_t b = kBins - 1; b > 0; --b) {
      add(box, boxes[b]);
      count += counts[b];
      after[b] = half_area(box) * count;
    }
    box = {};
    count = 0;
    std::uint32_t best = 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t b = 1; b < kBins; ++b) {
      add(box, boxes[b - 1]);
      count += counts[b - 1];
      const double cost = half_area(box) * count + after[b];
      if (cost < least) {
        least = cost;
        best = b;
      }
    }
    return best;
  }

  unsigned threads_;
  std::vector<Item> items_;
};

BoxTree::BoxTree(std::span<const Box3> boxes, unsigned threads) {
  assert(boxes.size() < std::size_t{1} << 31);
  BoxTreeBuilder(boxes, threads).build(*this);
}

}  // namespace mesocell
