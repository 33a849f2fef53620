#include "sdk/shade/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mesocell {

Vec3 Environment::pixel(std::int64_t x, std::int64_t y) const {
  x = (x % std::int64_t{width_} + width_) % width_;  // around the horizon
  y = std::clamp<std::int64_t>(y, 0, std::int64_t{height_} - 1);
  const float* p = rgb_.data() + 3 * (x + std::int64_t{width_} * y);
  return {p[0], p[1], p[2]};
}

Vec3 Environment::radiance(Vec3 direction) const {
  if (rgb_.empty()) return color_;
  const Vec3 d = normalize(direction);
  const double u = 0.5 + std::atan2(d.x, -d.z) / (2 * std::numbers::pi);
  const double v = std::acos(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi;
  const double x = u * width_ - 0.5, y = v * height_ - 0.5;
  const std::int64_t i = std::int64_t(std::floor(x)), j = std::int64_t(std::floor(y));
  const double fx = x - double(i), fy = y - double(j);
  return (pixel(i, j) * (1 - fx) + pixel(i + 1, j) * fx) * (1 - fy) +
         (pixel(i, j + 1) * (1 - fx) + pixel(i + 1, j + 1) * fx) * fy;
}

}  // namespace mesocell
