#pragma once

#include <cstdint>
#include <optional>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/ray.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// What the user gave of a camera; the rest is chosen so that the box fills the picture.
struct CameraOptions {
  std::optional<Vec3> eye = std::nullopt, look = std::nullopt, up = std::nullopt;
  double fov_degrees = 35;  ///< vertical, in (0, 180)
};

/// A pinhole camera, right-handed.
class Camera {
 public:
  /// Frames `box` with the given options; `width`, `height` in pixels, both > 0.
  /// Errors: kUsage if the eye is at the point looked at, or up is along the view.
  [[nodiscard]] static Result<Camera> make(const Box3& box, const CameraOptions& options, std::uint32_t width,
                                           std::uint32_t height);

  /// The ray through a point of the picture: x to the right, y down, pixel centres at .5; unit direction.
  [[nodiscard]] Ray ray(double x, double y) const;

  [[nodiscard]] Vec3 eye() const { return eye_; }
  [[nodiscard]] Vec3 forward() const { return forward_; }

 private:
  Camera() = default;

  Vec3 eye_, forward_;
  Vec3 right_, up_;  ///< half the picture's width and height at distance 1
  double width_ = 0, height_ = 0;
};

}  // namespace mesocell
