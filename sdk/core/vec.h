#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// A point or direction in 3-space, double precision.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  constexpr double operator[](std::size_t a) const { return a == 0 ? x : a == 1 ? y : z; }
  constexpr double& operator[](std::size_t a) { return a == 0 ? x : a == 1 ? y : z; }
  constexpr bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(double s, Vec3 a) { return a * s; }
constexpr Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// `a` scaled to length 1; the zero vector stays zero.
inline Vec3 normalize(Vec3 a) {
  const double l = length(a);
  return l > 0 ? a / l : a;
}
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
constexpr Vec3 min(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
constexpr Vec3 max(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
inline Vec3 to_vec3(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }
inline std::array<double, 3> to_array(Vec3 a) { return {a.x, a.y, a.z}; }

/// An axis-aligned box; empty until a point is added.
struct Box3 {
  Vec3 min{kInf, kInf, kInf};
  Vec3 max{-kInf, -kInf, -kInf};

  void add(Vec3 p) {
    min = mesocell::min(min, p);
    max = mesocell::max(max, p);
  }
  [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  [[nodiscard]] Vec3 extent() const { return max - min; }

 private:
  static constexpr double kInf = std::numeric_limits<double>::infinity();
};

}  // namespace mesocell
