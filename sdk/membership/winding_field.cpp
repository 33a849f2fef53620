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
/// A part whose dipole is off by less than this share of its area at unit distance is not looked into.
constexpr double kDipoleError = 1e-3;
/// Bounds the rounding of one triangle's share, whose angle is within a few units in the last place.
constexpr double kRounding = 1e-14;

/// Squared distance of two closed boxes, 0 where they meet.
double squared_distance(const Box3& a, const Box3& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({0.0, a.min[k] - b.max[k], b.min[k] - a.max[k]});
    sum += d * d;
  }
  return sum;
}

/// Side of p + (ε, ε², ε³) of the plane through a, b, c; 0 if they are collinear.
int side(Vec3 a, Vec3 b, Vec3 c, Vec3 p) {
  if (const int s = orientation_3d(a, b, c, p)) return s;
  // The components of the normal, in the order of the powers of ε.
  if (const int s = orientation_2d(a.y, a.z, b.y, b.z, c.y, c.z)) return s;
  if (const int s = orientation_2d(a.z, a.x, b.z, b.x, c.z, c.x)) return s;
  return orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
}

/// Share of the winding number of one triangle. [van Oosterom, Strackee 1983]
double share(const std::array<Vec3, 3>& triangle, Vec3 p) {
  const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
  const double la = length(a), lb = length(b), lc = length(c), product = la * lb * lc;
  double volume = dot(a, cross(b, c));
  const double rest = product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  // Near the plane the sign decides between both sides of a triangle; there rounding must not.
  if (std::abs(volume) < 1e-12 * product || product == 0) {
    const int s = -side(triangle[0], triangle[1], triangle[2], p);
    if (s == 0) return 0;
    volume = s * std::abs(volume);
  }
  return 2 * std::atan2(volume, rest) / kSphere;
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
  for (std::uint32_t t = begin; t < end; ++t)
    for (const Vec3& v : triangles_[t]) node.radius = std::max(node.radius, length(v - node.centre));
  if (end - begin > kLeaf) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    node.left = build(begin, middle);
    node.right = build(middle, end);
  }
  nodes_[index] = node;
  return index;
}

WindingField::Value WindingField::approximate(Vec3 p) const {
  Value value;
  if (nodes_.empty()) return value;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const Vec3 d = node.centre - p;
    const double distance = length(d), gap = distance - node.radius;
    if (gap > 0) {
      // The next term of the expansion: r/r³ changes by at most 2/gap³ per length.
      const double error = node.area * 2 * node.radius / (gap * gap * gap) / kSphere;
      if (error < kDipoleError * node.area / (distance * distance) / kSphere || error < 1e-12) {
        value.winding += dot(node.dipole, d) / (distance * distance * distance) / kSphere;
        value.error += error;
        continue;
      }
    }
    if (node.left == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) value.winding += share(triangles_[t], p);
      value.error += kRounding * (node.end - node.begin);
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  return value;
}

WindingField::Value WindingField::sum(Vec3 p) const {
  Value value;
  for (const std::array<Vec3, 3>& triangle : triangles_) value.winding += share(triangle, p);
  value.error = kRounding * double(triangles_.size());
  return value;
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
    const bool far = squared > dot(extent, extent);
    if (far || node.left == 0) {
      const double half = 0.5 * (node.end - node.begin);
      sum += squared > 0 ? std::min(half, node.area / squared / kSphere) : half;
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
      for (std::uint32_t t = node.begin; t < node.end; ++t) {
        Box3 own;
        for (const Vec3& v : triangles_[t]) own.add(v);
        if (squared_distance(own, box) == 0) return false;
      }
      continue;
    }
    stack[size++] = node.left;
    stack[size++] = node.right;
  }
  return true;
}

BoundaryGradient::BoundaryGradient(const std::vector<std::array<Vec3, 2>>& segments) {
  std::vector<Box3> boxes(segments.size());
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const Vec3& v : segments[s]) boxes[s].add(v);
  const BoxTree tree(boxes);
  for (const std::uint32_t s : tree.order()) segments_.push_back(segments[s]);
  if (!segments_.empty()) build(0, std::uint32_t(segments_.size()));
}

std::uint32_t BoundaryGradient::build(std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t index = std::uint32_t(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  for (std::uint32_t s = begin; s < end; ++s) {
    for (const Vec3& v : segments_[s]) node.box.add(v);
    node.length += mesocell::length(segments_[s][1] - segments_[s][0]);
  }
  if (end - begin > 1) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    node.left = build(begin, middle);
    node.right = build(middle, end);
  }
  nodes_[index] = node;
  return index;
}

double BoundaryGradient::bound(const Box3& box) const {
  double sum = 0;
  if (nodes_.empty()) return sum;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const double squared = squared_distance(node.box, box);
    const Vec3 extent = node.box.extent();
    // At (√2 - 1)⁻¹ diagonals away the nearest and the farthest of it differ by a factor of √2.
    if (squared > 6 * dot(extent, extent) || node.left == 0) {
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
