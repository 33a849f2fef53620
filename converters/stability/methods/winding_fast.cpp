// The generalized winding number with far parts of the mesh as dipoles. [Barill 2018]
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "converters/stability/voxelizer.h"
#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

/// A part is a dipole from beyond this many of its radii.
constexpr double kBeta = 2;
constexpr std::uint32_t kLeaf = 8;

class DipoleTree {
 public:
  explicit DipoleTree(const TriangleMesh& mesh) : order_(mesh.triangles.size()) {
    for (const Triangle& t : mesh.triangles)
      triangles_.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    std::iota(order_.begin(), order_.end(), 0u);
    if (!order_.empty()) build(0, std::uint32_t(order_.size()));
  }

  [[nodiscard]] double winding(Vec3 p) const {
    return nodes_.empty() ? 0 : add(nodes_[0], p) / (4 * std::numbers::pi);
  }

 private:
  struct Node {
    Vec3 centre, dipole;
    double radius = 0;
    std::uint32_t begin = 0, end = 0, left = 0, right = 0;  ///< left 0: a leaf
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t index = std::uint32_t(nodes_.size());
    nodes_.emplace_back();
    Node node;
    node.begin = begin;
    node.end = end;
    double area = 0;
    Vec3 weighted, mean;
    Box3 box;
    for (std::uint32_t k = begin; k < end; ++k) {
      const auto& [a, b, c] = triangles_[order_[k]];
      const Vec3 normal = cross(b - a, c - a) * 0.5, middle = (a + b + c) / 3;
      node.dipole = node.dipole + normal;
      weighted = weighted + middle * length(normal);
      mean = mean + middle;
      area += length(normal);
      box.add(middle);
    }
    node.centre = area > 0 ? weighted / area : mean / double(end - begin);
    for (std::uint32_t k = begin; k < end; ++k)
      for (const Vec3& v : triangles_[order_[k]])
        node.radius = std::max(node.radius, length(v - node.centre));
    if (end - begin > kLeaf) {
      const Vec3 extent = box.extent();
      const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                               : extent.y >= extent.z                       ? 1
                                                                            : 2;
      const std::uint32_t middle = begin + (end - begin) / 2;
      const auto key = [&](std::uint32_t t) {
        const auto& [a, b, c] = triangles_[t];
        return std::pair(a[axis] + b[axis] + c[axis], t);
      };
      std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                       [&](std::uint32_t s, std::uint32_t t) { return key(s) < key(t); });
      node.left = build(begin, middle);
      node.right = build(middle, end);
    }
    nodes_[index] = node;
    return index;
  }

  /// Solid angle.
  [[nodiscard]] double add(const Node& node, Vec3 p) const {
    const Vec3 d = node.centre - p;
    const double distance = length(d);
    if (distance > kBeta * node.radius) return dot(d, node.dipole) / (distance * distance * distance);
    if (node.left) return add(nodes_[node.left], p) + add(nodes_[node.right], p);
    double sum = 0;
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const auto& [u, v, w] = triangles_[order_[k]];
      const Vec3 a = u - p, b = v - p, c = w - p;
      const double la = length(a), lb = length(b), lc = length(c);
      sum += 2 *
             std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return sum;
  }

  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace

Status voxelize_winding_fast(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  const DipoleTree tree(mesh);
  const Index3& size = out.size();
  parallel_for(size[2], threads, [&](std::size_t z, unsigned) {
    for (std::uint32_t y = 0; y < size[1]; ++y)
      for (std::uint32_t x = 0; x < size[0]; ++x)
        if (std::abs(tree.winding({x + 0.5, y + 0.5, double(z) + 0.5})) > 0.5)
          out.set(x, y, std::uint32_t(z));
  });
  return {};
}

}  // namespace mesocell
