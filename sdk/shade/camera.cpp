#include "sdk/shade/camera.h"

#include <cmath>
#include <numbers>

namespace mesocell {
namespace {

/// Where the eye is, seen from the object, if the user does not say: in front, a little to the right and
/// above.
constexpr Vec3 kDefaultView{0.42, 0.32, 1.0};
/// Room around the object, as a factor of its size in the picture.
constexpr double kMargin = 1.02;

/// The least distance from the box's centre, against `forward`, at which all its corners are in the picture.
double framing_distance(const Box3& box, Vec3 forward, Vec3 right, Vec3 up, double tan_x, double tan_y) {
  const Vec3 centre = box.min + box.extent() * 0.5;
  double distance = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner{k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                      k & 4 ? box.max.z : box.min.z};
    const Vec3 v = (corner - centre) * kMargin;
    const double side = std::max(std::abs(dot(v, right)) / tan_x, std::abs(dot(v, up)) / tan_y);
    distance = std::max(distance, side - dot(v, forward));
  }
  return distance;
}

}  // namespace

Result<Camera> Camera::make(const Box3& box, const CameraOptions& options, std::uint32_t width,
                            std::uint32_t height) {
  const auto usage = [](const char* text) { return Error{ErrorCode::kUsage, text}; };
  if (!(options.fov_degrees > 0 && options.fov_degrees < 180))
    return usage("the field of view is not between 0 and 180 degrees");
  Camera camera;
  camera.width_ = width;
  camera.height_ = height;
  const double tan_y = std::tan(options.fov_degrees * std::numbers::pi / 360);
  const double tan_x = tan_y * width / height;

  const Vec3 look = options.look.value_or(box.min + box.extent() * 0.5);
  camera.forward_ = options.eye ? normalize(look - *options.eye) : normalize(-kDefaultView);
  if (!(length(camera.forward_) > 0.5)) return usage("the eye is at the point looked at");
  Vec3 up = normalize(options.up.value_or(Vec3{0, 1, 0}));
  if (!options.up && length(cross(camera.forward_, up)) < 1e-6) up = {0, 0, -1};  // straight down or up
  const Vec3 right = normalize(cross(camera.forward_, up));
  if (!(length(cross(camera.forward_, up)) > 1e-9)) return usage("up is zero or along the view");
  up = cross(right, camera.forward_);
  camera.eye_ =
      options.eye ? *options.eye
                  : look - camera.forward_ * framing_distance(box, camera.forward_, right, up, tan_x, tan_y);
  camera.right_ = right * tan_x;
  camera.up_ = up * tan_y;
  return camera;
}

Ray Camera::ray(double x, double y) const {
  return {eye_, normalize(forward_ + right_ * (2 * x / width_ - 1) + up_ * (1 - 2 * y / height_))};
}

}  // namespace mesocell
