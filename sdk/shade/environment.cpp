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

namespace {

/// Light of the sky from a direction.
Vec3 sky_light(Vec3 d) {
  static const Vec3 sun = normalize({-0.5, 0.6, 0.62});
  if (d.y >= 0) {
    if (dot(d, sun) > 0.995) return {6, 5.6, 5};
    return Vec3{0.62, 0.74, 0.88} * (1 - d.y) + Vec3{0.24, 0.42, 0.78} * d.y;
  }
  // Squares on a plane one unit below, fading into haze where they get smaller than a pixel.
  const double distance = -1 / d.y, haze = std::min(1.0, distance / 12);
  const bool dark =
      (std::int64_t(std::floor(d.x * distance)) + std::int64_t(std::floor(d.z * distance))) % 2 != 0;
  const Vec3 square = dark ? Vec3{0.16, 0.15, 0.14} : Vec3{0.62, 0.58, 0.52};
  return square * (1 - haze) + Vec3{0.52, 0.55, 0.58} * haze;
}

}  // namespace

Environment make_sky() {
  constexpr std::uint32_t width = 1024, height = 512, samples = 4;  // along each axis, lest edges be stairs
  std::vector<float> rgb;
  rgb.reserve(3 * std::size_t{width} * height);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      Vec3 sum;
      for (std::uint32_t s = 0; s < samples * samples; ++s) {
        const double v = (y + (s / samples + 0.5) / samples) / height * std::numbers::pi,
                     u = ((x + (s % samples + 0.5) / samples) / width - 0.5) * 2 * std::numbers::pi;
        sum = sum + sky_light({std::sin(v) * std::sin(u), std::cos(v), -std::sin(v) * std::cos(u)});
      }
      for (std::size_t c = 0; c < 3; ++c) rgb.push_back(float(sum[c] / (samples * samples)));
    }
  return Environment(std::move(rgb), width, height);
}

}  // namespace mesocell
