#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "format/api.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// What a ray sees that leaves the scene: one color, or a latitude-longitude picture with +y up, whose middle
/// column is seen along -z and whose right half along +x.
class Environment {
 public:
  explicit Environment(Vec3 color) : color_(color) {}
  /// `rgb`: linear light, 3 a pixel, rows from the top; `width`, `height` > 0.
  Environment(std::vector<float> rgb, std::uint32_t width, std::uint32_t height)
      : rgb_(std::move(rgb)), width_(width), height_(height) {}

  /// Radiance from a direction, which need not have length 1; bilinear.
  [[nodiscard]] Vec3 radiance(Vec3 direction) const;

 private:
  [[nodiscard]] Vec3 pixel(std::int64_t x, std::int64_t y) const;

  Vec3 color_;
  std::vector<float> rgb_;
  std::uint32_t width_ = 0, height_ = 0;
};

/// A sky with a sun over a checkered ground, so that mirrors and glass have something to show without a
/// picture.
[[nodiscard]] Environment make_sky();

}  // namespace mesocell
