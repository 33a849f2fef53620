#include "sdk/membership/cap_gradient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdk/membership/box_distance.h"

namespace mesocell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSphere = 4 * std::numbers::pi;

}  // namespace

CapGradient::CapGradient(const std::vector<Cap>& caps) {
  std::vector<Node> all;
  for (const Cap& cap : caps) {
    std::vector<Node> areas, lengths;
    Node whole;
    for (const std::array<Vec3, 3>& t : cap.triangles) {
      Node& node = areas.emplace_back();
      for (const Vec3& v : t) node.box.add(v);
      node.area = length(cross(t[1] - t[0], t[2] - t[0])) / 2;
      node.item = std::uint32_t(triangles_.size());
      triangles_.push_back(t);
      whole.area += node.area;
    }
    for (const std::array<Vec3, 2>& s : cap.loop) {
      Node& node = lengths.emplace_back();
      for (const Vec3& v : s) {
        node.box.add(v);
        whole.box.add(v);
      }
      node.length = length(s[1] - s[0]);
      whole.length += node.length;
    }
    whole.item = std::uint32_t(roots_.size());
    all.push_back(whole);
    const std::uint32_t by_triangles = build(areas, 0, areas.size());
    roots_.push_back({by_triangles, build(lengths, 0, lengths.size())});
  }
  if (!all.empty()) root_ = build(all, 0, all.size());
}

std::uint32_t CapGradient::build(std::vector<Node>& items, std::size_t begin, std::size_t end) {
  const std::uint32_t index = std::uint32_t(nodes_.size());
  if (end - begin == 1) {
    nodes_.push_back(items[begin]);
    return index;
  }
  Node node;
  for (std::size_t k = begin; k < end; ++k) {
    node.box.add(items[k].box.min);
    node.box.add(items[k].box.max);
    node.area += items[k].area;
    node.length += items[k].length;
  }
  // Halved across the longest side.
  const Vec3 extent = node.box.extent();
  const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const auto at = [&](std::size_t k) { return items.begin() + std::ptrdiff_t(k); };
  const std::size_t middle = begin + (end - begin) / 2;
  std::nth_element(at(begin), at(middle), at(end), [&](const Node& a, const Node& b) {
    const double ca = a.box.min[axis] + a.box.max[axis], cb = b.box.min[axis] + b.box.max[axis];
    return ca < cb || (ca == cb && a.item < b.item);
  });
  nodes_.emplace_back();
  node.left = build(items, begin, middle);
  node.right = build(items, middle, end);
  nodes_[index] = node;
  return index;
}

double CapGradient::bound(const Box3& box) const {
  double sum = 0;
  if (nodes_.empty()) return sum;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = root_;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const double squared = squared_distance(node.box, box);
    const Vec3 extent = node.box.extent();
    if (squared > dot(extent, extent)) {
      sum += std::min(2 * node.area / std::sqrt(squared), node.length) / squared / kSphere;
      continue;
    }
    if (node.left == 0) {
      const double length = by_length(roots_[node.item].loop, box);
      sum += std::min(length, by_area(roots_[node.item].triangles, box, length));
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  return sum;
}

double CapGradient::by_area(std::uint32_t root, const Box3& box, double enough) const {
  double sum = 0;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = root;
  while (size > 0 && sum < enough) {
    const Node& node = nodes_[stack[--size]];
    const double squared = squared_distance(node.box, box);
    const Vec3 extent = node.box.extent();
    if (node.left == 0) {
      const double distance = distance_bound(triangles_[node.item], box);
      if (distance == 0) return kInfinity;
      sum += 2 * node.area / (distance * distance * distance) / kSphere;
    } else if (squared > dot(extent, extent)) {
      sum += 2 * node.area / (squared * std::sqrt(squared)) / kSphere;
    } else {
      stack[size++] = node.left;
      stack[size++] = node.right;
    }
  }
  return sum;
}

double CapGradient::by_length(std::uint32_t root, const Box3& box) const {
  double sum = 0;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = root;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const double squared = squared_distance(node.box, box);
    const Vec3 extent = node.box.extent();
    if (node.left == 0 || squared > dot(extent, extent)) {
      if (squared == 0) return kInfinity;
      sum += node.length / squared / kSphere;
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  return sum;
}

}  // namespace mesocell
