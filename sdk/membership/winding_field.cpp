#include "sdk/membership/winding_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sdk/core/box_tree.h"
#include "sdk/membership/box_distance.h"
#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

constexpr double kAllAround = 4 * std::numbers::pi;
constexpr std::uint32_t kLeaf = 4;
/// Bounds the rounding of one triangle's share, where its angle is well conditioned.
constexpr double kRounding = 1e-14;
/// What an angle is off by at most, where the point is on an edge or so near that rounding hides its side.
constexpr double kHalf = 0.5;

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
    return {2 * angle_ / kAllAround, error_};
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
  return sum / kAllAround;
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
  node.moment_root = std::sqrt(std::sqrt(3 * second_moment / kAllAround));
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
                       (squared * distance) / kAllAround;
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
          2 * (moment * moment + 3 * node.area * radius * radius / kAllAround) / (gap * gap * gap * gap);
      if (error < tolerance) {
        const std::array<double, 9>& m = node.quadrupole;
        const Vec3 md{m[0] * d.x + m[1] * d.y + m[2] * d.z, m[3] * d.x + m[4] * d.y + m[5] * d.z,
                      m[6] * d.x + m[7] * d.y + m[8] * d.z};
        const double cube = squared * distance * kAllAround, along = dot(node.dipole, d);
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
        const double error = radius * radius / 2 * std::min(6 * area / kAllAround / squares, 1.5) / squares;
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
      sum += std::min(all, node.area / squared / kAllAround);
      continue;
    }
    if (node.left == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) {
        const double distance = distance_bound(triangles_[t], box);
        const double area =
            length(cross(triangles_[t][1] - triangles_[t][0], triangles_[t][2] - triangles_[t][0])) / 2;
        sum += distance > 0 ? std::min(0.5, area / (distance * distance) / kAllAround) : 0.5;
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

}  // namespace mesocell
