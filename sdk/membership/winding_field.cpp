#include "sdk/membership/winding_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdk/core/box_tree.h"
#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSphere = 4 * std::numbers::pi;
constexpr std::uint32_t kLeaf = 4;
/// Bounds the rounding of one triangle's share, where its angle is well conditioned.
constexpr double kRounding = 1e-14;
/// What an angle is off by at most, where the point is on an edge or so near that rounding hides its side.
constexpr double kHalf = 0.5;

/// Squared distance of two closed boxes, 0 where they meet.
double squared_distance(const Box3& a, const Box3& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({0.0, a.min[k] - b.max[k], b.min[k] - a.max[k]});
    sum += d * d;
  }
  return sum;
}

/// Bounds the distance of a triangle and a box from below: by the gap between them along some directions,
/// those that tell slivers from their boxes among them.
double distance_bound(const std::array<Vec3, 3>& t, const Box3& box) {
  const Vec3 centre = (box.min + box.max) / 2, half = box.extent() / 2;
  double bound = 0;
  const auto along = [&](Vec3 axis) {
    const double norm = length(axis);
    if (!(norm > 0)) return;
    const double middle = dot(centre, axis);
    const double reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    const double a = dot(t[0], axis), b = dot(t[1], axis), c = dot(t[2], axis);
    bound = std::max({bound, (std::min({a, b, c}) - middle - reach) / norm,
                      (middle - reach - std::max({a, b, c})) / norm});
  };
  along({1, 0, 0});
  along({0, 1, 0});
  along({0, 0, 1});
  along(cross(t[1] - t[0], t[2] - t[0]));
  Vec3 edge = t[1] - t[0], from = t[0];
  for (int e = 1; e < 3; ++e)
    if (const Vec3 other = t[(e + 1) % 3] - t[e]; dot(other, other) > dot(edge, edge)) {
      edge = other;
      from = t[e];
    }
  if (dot(edge, edge) > 0) along(centre - from - edge * (dot(centre - from, edge) / dot(edge, edge)));
  // What rounding may have added, in voxels of a grid whose coordinates have a few more digits.
  return std::max(0.0, bound - 1e-6);
}

/// Side of p + (ε, ε², ε³) of the plane through a, b, c; 0 if they are collinear.
int side(Vec3 a, Vec3 b, Vec3 c, Vec3 p) {
  if (const int s = orientation_3d(a, b, c, p)) return s;
  // The components of the normal, in the order of the powers of ε.
  if (const int s = orientation_2d(a.y, a.z, b.y, b.z, c.y, c.z)) return s;
  if (const int s = orientation_2d(a.z, a.x, b.z, b.x, c.z, c.x)) return s;
  return orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
}

/// Sums shares of triangles: their half solid angles are those of complex numbers, which are multiplied as
/// long as the angle of the product is certain.
class ShareSum {
 public:
  /// [van Oosterom, Strackee 1983]
  void add(const std::array<Vec3, 3>& triangle, Vec3 p) {
    const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
    const double la = length(a), lb = length(b), lc = length(c), product = la * lb * lc;
    double volume = dot(a, cross(b, c));
    const double rest = product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    // Near the plane the sign decides between both sides of a triangle; there rounding must not.
    if (std::abs(volume) < 1e-12 * product || product == 0) {
      if (rest > 1e-6 * product) return;  // seen from its edge
      const int s = -side(triangle[0], triangle[1], triangle[2], p);
      if (s == 0) return;
      volume = s * std::abs(volume);
    }
    const double size = std::sqrt(volume * volume + rest * rest);
    if (!(size > 1e-12 * product)) {
      error_ += kHalf;
      return;
    }
    error_ += kRounding * (1 + 0.1 * product / size);
    const double x = rest / size, y = volume / size;
    if (x <= 0) {
      angle_ += std::atan2(y, x);
      return;
    }
    // Both angles are below a right one, so that of the product is below two.
    const double real = x * real_ - y * imaginary_;
    imaginary_ = x * imaginary_ + y * real_;
    real_ = real;
    if (real_ <= 0) flush();
  }

  [[nodiscard]] WindingField::Value total() {
    flush();
    return {2 * angle_ / kSphere, error_};
  }

 private:
  void flush() {
    angle_ += std::atan2(imaginary_, real_);
    real_ = 1;
    imaginary_ = 0;
  }

  double angle_ = 0, error_ = 0, real_ = 1, imaginary_ = 0;
};

/// How a triangle's share changes with p, off the triangle's edges. [Biot-Savart, edge by edge]
Vec3 share_gradient(const std::array<Vec3, 3>& triangle, Vec3 p) {
  Vec3 sum;
  for (std::size_t e = 0; e < 3; ++e) {
    const Vec3 a = triangle[e] - p, b = triangle[(e + 1) % 3] - p;
    const double la = length(a), lb = length(b);
    const double divisor = la * lb * (la * lb + dot(a, b));
    if (divisor > 0) sum = sum + cross(a, b) * ((la + lb) / divisor);
  }
  return sum / kSphere;
}

}  // namespace

WindingField::WindingField(const std::vector<std::array<Vec3, 3>>& triangles) {
  std::vector<Box3> boxes(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const Vec3& v : triangles[t]) boxes[t].add(v);
  const BoxTree tree(boxes);
  for (const std::uint32_t t : tree.order()) triangles_.push_back(triangles[t]);
  if (!triangles_.empty()) build(0, std::uint32_t(triangles_.size()));
}

std::uint32_t WindingField::build(std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t index = std::uint32_t(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  for (std::uint32_t t = begin; t < end; ++t) {
    const auto& [a, b, c] = triangles_[t];
    const Vec3 twice = cross(b - a, c - a);
    const double area = length(twice) / 2;
    for (const Vec3& v : triangles_[t]) node.box.add(v);
    node.dipole = node.dipole + twice / 2;
    node.centre = node.centre + (a + b + c) * (area / 3);
    node.area += area;
  }
  node.centre = node.area > 0 ? node.centre / node.area : (node.box.min + node.box.max) / 2;
  double second_moment = 0;  // ∫ |x - centre|²
  for (std::uint32_t t = begin; t < end; ++t) {
    const auto& [a, b, c] = triangles_[t];
    const Vec3 directed = cross(b - a, c - a) / 2, at = (a + b + c) / 3 - node.centre;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) node.quadrupole[3 * i + j] += directed[i] * at[j];
    double squares = 9 * dot(at, at);
    for (const Vec3& v : triangles_[t]) {
      squares += dot(v - node.centre, v - node.centre);
      node.radius = std::max(node.radius, length(v - node.centre));
    }
    second_moment += length(directed) * squares / 12;
  }
  // The second derivative of r/r³ is at most 6/r⁴.
  node.moment_root = std::sqrt(std::sqrt(3 * second_moment / kSphere));
  if (end - begin > kLeaf) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    node.left = build(begin, middle);
    node.right = build(middle, end);
  }
  nodes_[index] = node;
  return index;
}

WindingField::Value WindingField::approximate(Vec3 p, double tolerance) const {
  Value value;
  if (nodes_.empty()) return value;
  ShareSum near;
  const double far = 1 / std::sqrt(std::sqrt(tolerance));
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const Vec3 d = node.centre - p;
    const double squared = dot(d, d), least = node.radius + far * node.moment_root;
    if (squared > least * least) {
      const double distance = std::sqrt(squared), gap = distance - node.radius, g = gap * gap;
      const double error = node.moment_root * node.moment_root / g;
      const std::array<double, 9>& m = node.quadrupole;
      const Vec3 md{m[0] * d.x + m[1] * d.y + m[2] * d.z, m[3] * d.x + m[4] * d.y + m[5] * d.z,
                    m[6] * d.x + m[7] * d.y + m[8] * d.z};
      value.winding += (dot(node.dipole, d) + m[0] + m[4] + m[8] - 3 * dot(md, d) / squared) /
                       (squared * distance) / kSphere;
      value.error += error * error;
      continue;
    }
    if (node.left == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) near.add(triangles_[t], p);
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  const Value shares = near.total();
  return {value.winding + shares.winding, value.error + shares.error};
}

void WindingField::localize(const Box3& box, double tolerance, Local& local) const {
  const Vec3 centre = (box.min + box.max) / 2;
  const double radius = length(box.extent()) / 2;
  ShareSum shares;
  local.centre = centre;
  local.gradient = {};
  local.winding = local.error = 0;
  local.near.clear();
  if (nodes_.empty()) return;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const Vec3 d = node.centre - centre;
    const double squared = dot(d, d), distance = std::sqrt(squared), gap = distance - node.radius - radius;
    if (gap > 0) {
      // As in approximate(), where the place in the ball adds to that on the surface; twice the squares bound
      // that of the sum.
      const double moment = node.moment_root * node.moment_root;
      const double error =
          2 * (moment * moment + 3 * node.area * radius * radius / kSphere) / (gap * gap * gap * gap);
      if (error < tolerance) {
        const std::array<double, 9>& m = node.quadrupole;
        const Vec3 md{m[0] * d.x + m[1] * d.y + m[2] * d.z, m[3] * d.x + m[4] * d.y + m[5] * d.z,
                      m[6] * d.x + m[7] * d.y + m[8] * d.z};
        const double cube = squared * distance * kSphere, along = dot(node.dipole, d);
        local.winding += (along + m[0] + m[4] + m[8] - 3 * dot(md, d) / squared) / cube;
        local.gradient = local.gradient + (d * (3 * along / squared) - node.dipole) / cube;
        local.error += error;
        continue;
      }
    }
    if (node.left == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) {
        const std::array<Vec3, 3>& triangle = triangles_[t];
        // The second derivative of a share: that of a dipole layer, of the triangle or of its whole plane.
        const double squares = std::pow(distance_bound(triangle, box), 2);
        const double area = length(cross(triangle[1] - triangle[0], triangle[2] - triangle[0])) / 2;
        const double error = radius * radius / 2 * std::min(6 * area / kSphere / squares, 1.5) / squares;
        if (!(error < tolerance)) {
          local.near.push_back(t);
          continue;
        }
        shares.add(triangle, centre);
        local.gradient = local.gradient + share_gradient(triangle, centre);
        local.error += error;
      }
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  const Value total = shares.total();
  local.winding += total.winding;
  local.error += total.error;
}

WindingField::Value WindingField::at(const Local& local, Vec3 p) const {
  ShareSum near;
  for (const std::uint32_t t : local.near) near.add(triangles_[t], p);
  const Value shares = near.total();
  return {local.winding + dot(local.gradient, p - local.centre) + shares.winding, local.error + shares.error};
}

WindingField::Value WindingField::sum(Vec3 p) const {
  ShareSum sum;
  for (const std::array<Vec3, 3>& triangle : triangles_) sum.add(triangle, p);
  return sum.total();
}

double WindingField::bound(const Box3& box, double enough) const {
  double sum = 0;
  if (nodes_.empty()) return sum;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0 && sum <= enough) {
    const Node& node = nodes_[stack[--size]];
    const double squared = squared_distance(node.box, box);
    const Vec3 extent = node.box.extent();
    const double all = 0.5 * (node.end - node.begin);
    if (squared > dot(extent, extent)) {
      sum += std::min(all, node.area / squared / kSphere);
      continue;
    }
    if (node.left == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) {
        const double distance = distance_bound(triangles_[t], box);
        const double area =
            length(cross(triangles_[t][1] - triangles_[t][0], triangles_[t][2] - triangles_[t][0])) / 2;
        sum += distance > 0 ? std::min(0.5, area / (distance * distance) / kSphere) : 0.5;
      }
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  return sum;
}

bool WindingField::clear_of(const Box3& box) const {
  if (nodes_.empty()) return true;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    if (squared_distance(node.box, box) > 0) continue;
    if (node.left == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t)
        if (distance_bound(triangles_[t], box) == 0) return false;
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  return true;
}

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
