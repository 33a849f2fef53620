#include "converters/bench/views.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "sdk/core/rng.h"

namespace mesocell {
namespace {

constexpr double kFullDistance = 1.1, kFullFov = 48.46;
/// Pixels of the picture that windows are looked for in.
constexpr std::uint32_t kMaskWidth = 256, kMaskHeight = 192;
constexpr double kCover = 0.9;
constexpr double kCloseTiles = 1.5, kGrazeTiles = 3, kGrazeEdges = 0.5;

constexpr std::array<std::string_view, 5> kNames = {"full", "cover90", "close", "grazing", "inside"};

double longest_side(const Box3& box) {
  const Vec3 e = box.extent();
  return std::max({e.x, e.y, e.z});
}

CameraOptions full_view(const Box3& box) {
  const Vec3 centre = box.min + box.extent() * 0.5;
  return {
      .eye = centre - Vec3{0, 0, kFullDistance * longest_side(box)}, .look = centre, .fov_degrees = kFullFov};
}

/// What the full view sees, coarsely.
struct Mask {
  std::vector<StreamHit> hits;  ///< by rows
  std::vector<Ray> rays;
  std::vector<std::uint32_t> sums;  ///< of hits left of and above a corner, (width + 1) × (height + 1)

  [[nodiscard]] double cover(std::uint32_t x, std::uint32_t y, std::uint32_t w, std::uint32_t h) const {
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return sums[j * (kMaskWidth + 1) + i]; };
    return double(at(x + w, y + h) + at(x, y) - at(x + w, y) - at(x, y + h)) / (w * h);
  }
};

Mask make_mask(const Caster& exact, const Camera& camera) {
  Mask mask;
  for (std::uint32_t y = 0; y < kMaskHeight; ++y)
    for (std::uint32_t x = 0; x < kMaskWidth; ++x) mask.rays.push_back(camera.ray(x + 0.5, y + 0.5));
  mask.hits.resize(mask.rays.size());
  exact.first_hits(mask.rays, mask.hits);
  mask.sums.resize((kMaskWidth + 1) * (kMaskHeight + 1));
  for (std::uint32_t y = 0; y < kMaskHeight; ++y) {
    std::uint32_t row = 0;
    for (std::uint32_t x = 0; x < kMaskWidth; ++x) {
      row += mask.hits[y * kMaskWidth + x].hit();
      mask.sums[(y + 1) * (kMaskWidth + 1) + x + 1] = row + mask.sums[y * (kMaskWidth + 1) + x + 1];
    }
  }
  return mask;
}

/// Pixels of a mask: the largest of the picture's proportions that is covered enough, else the best covered
/// one of the smallest.
struct Window {
  double x = 0, y = 0;  ///< its middle
  double share = 1;     ///< its height of the picture's
};

Window find_window(const Mask& mask) {
  Window best;
  double best_cover = -1;
  for (std::uint32_t h = kMaskHeight; h >= 12; h -= 6) {
    const std::uint32_t w = h * kMaskWidth / kMaskHeight;
    for (std::uint32_t y = 0; y + h <= kMaskHeight; y += 2)
      for (std::uint32_t x = 0; x + w <= kMaskWidth; x += 2) {
        const double cover = mask.cover(x, y, w, h);
        // Of those that are covered enough the one that is so by the least.
        if (cover < kCover ? cover <= best_cover : best_cover >= kCover && cover >= best_cover) continue;
        best_cover = cover;
        best = {x + w / 2.0, y + h / 2.0, double(h) / kMaskHeight};
      }
    if (best_cover >= kCover) break;
  }
  return best;
}

double narrowed(double fov_degrees, double share) {
  const double half = fov_degrees * std::numbers::pi / 360;
  return std::atan(std::tan(half) * share) * 360 / std::numbers::pi;
}

/// The hit of a mask that is nearest to a place of it.
std::optional<std::size_t> nearest_hit(const Mask& mask, double x, double y) {
  std::optional<std::size_t> best;
  double best_distance = 0;
  for (std::size_t k = 0; k < mask.hits.size(); ++k) {
    if (!mask.hits[k].hit()) continue;
    const double dx = double(k % kMaskWidth) + 0.5 - x, dy = double(k / kMaskWidth) + 0.5 - y;
    const double distance = dx * dx + dy * dy;
    if (!best || distance < best_distance) {
      best = k;
      best_distance = distance;
    }
  }
  return best;
}

/// The unit normal of the plane that fits best to hits around one, by least squares of depth along the view.
Vec3 plane_normal(const Mask& mask, std::size_t middle, const Camera& camera, double radius) {
  const Vec3 forward = camera.forward();
  const Vec3 side =
      normalize(std::abs(forward.y) < 0.9 ? cross(forward, {0, 1, 0}) : cross(forward, {1, 0, 0}));
  const Vec3 up = cross(side, forward);
  const auto point = [&](std::size_t k) {
    return mask.rays[k].origin + mask.rays[k].direction * mask.hits[k].t;
  };
  const Vec3 at = point(middle);
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  for (std::size_t k = 0; k < mask.hits.size(); ++k) {
    if (!mask.hits[k].hit()) continue;
    const Vec3 d = point(k) - at;
    if (length(d) > radius) continue;
    const double u = dot(d, side), v = dot(d, up), w = dot(d, forward);
    n += 1, x += u, y += v, z += w, xx += u * u, xy += u * v, yy += v * v, xz += u * w, yz += v * w;
  }
  // Of depth = a u + b v + c, with the means taken out.
  xx -= x * x / n, xy -= x * y / n, yy -= y * y / n, xz -= x * z / n, yz -= y * z / n;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-12 * xx * yy)) return -forward;
  const double a = (xz * yy - yz * xy) / determinant, b = (yz * xx - xz * xy) / determinant;
  return normalize(side * a + up * b - forward);
}

/// The eye from which the middle of a grazing view is seen best: of several directions around the normal the
/// one whose first hit is nearest to it, higher if it would be within the object.
CameraOptions grazing_view(const Caster& exact, Vec3 at, Vec3 normal, double degrees, double tile_edge) {
  const double angle = degrees * std::numbers::pi / 180;
  const double distance = kGrazeEdges * longest_side(exact.object_box());
  const Vec3 side = normalize(std::abs(normal.x) < 0.7 ? cross(normal, {1, 0, 0}) : cross(normal, {0, 1, 0}));
  const Vec3 other = cross(normal, side);
  CameraOptions best;
  double best_distance = 0;
  for (int lift = 0; !best.eye && lift < 8; ++lift)
    for (int k = 0; k < 16; ++k) {
      const double turn = 2 * std::numbers::pi * k / 16;
      const Vec3 along = side * std::cos(turn) + other * std::sin(turn);
      const Vec3 look = at + normal * (lift * tile_edge / 2);
      const Vec3 eye = look + (along * std::cos(angle) + normal * std::sin(angle)) * distance;
      Hit hit;
      if (exact.inside(eye) || !exact.first_hit({eye, normalize(look - eye)}, hit)) continue;
      const double off = std::abs(hit.t - distance);
      if (best.eye && off >= best_distance) continue;
      best_distance = off;
      // So narrow that the angle of no ray is off by more than half.
      best = {.eye = eye, .look = look, .up = normal, .fov_degrees = std::min(degrees, 20.0)};
      if (degrees > 80) best.up = along;
    }
  return best;
}

/// The view from the empty place from which the most directions hit.
CameraOptions inside_view(const Caster& exact) {
  constexpr int kPlaces = 512;
  constexpr std::size_t kDirections = 64;
  const Box3 box = exact.object_box();
  Rng rng(1);
  CameraOptions best;
  int best_count = 0;
  std::array<Ray, kDirections> rays;
  std::array<StreamHit, kDirections> hits;
  for (int place = 0; place < kPlaces; ++place) {
    Vec3 eye;
    for (std::size_t a = 0; a < 3; ++a) eye[a] = rng.uniform(box.min[a], box.max[a]);
    Vec3 sum;
    for (Ray& ray : rays) {
      do {
        ray.direction = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
      } while (!(length(ray.direction) > 0.1 && length(ray.direction) <= 1));
      ray = {eye, normalize(ray.direction)};
    }
    if (exact.inside(eye)) continue;
    exact.first_hits(rays, hits);
    int count = 0;
    for (std::size_t k = 0; k < kDirections; ++k) {
      count += hits[k].hit();
      if (hits[k].hit()) sum = sum + rays[k].direction;
    }
    if (count <= best_count) continue;
    best_count = count;
    if (!(length(sum) > 1)) sum = {0, 0, 1};
    best = {.eye = eye, .look = eye + normalize(sum) * longest_side(box), .fov_degrees = 75};
  }
  return best;
}

}  // namespace

Result<BenchView> parse_view(std::string_view name) {
  if (name == "grazing") return BenchView{std::string(name), 5};
  if (std::ranges::find(kNames, name) != kNames.end()) return BenchView{std::string(name), 0};
  constexpr std::string_view kGrazing = "grazing-";
  if (name.starts_with(kGrazing)) {
    double degrees = 0;
    const std::string_view rest = name.substr(kGrazing.size());
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), degrees);
    if (error == std::errc() && end == rest.data() + rest.size() && degrees >= 0.1 && degrees <= 90)
      return BenchView{std::string(name), degrees};
  }
  std::string names;
  for (const std::string_view known : kNames) names += std::string(known) + ", ";
  return Error{ErrorCode::kUsage, "there is no camera '" + std::string(name) + "'; there are " + names +
                                      "and grazing-A with an angle A from 0.1 to 90 degrees"};
}

Result<PlacedView> make_view(const BenchView& view, const Caster& exact, double tile_edge,
                             std::uint32_t width, std::uint32_t height) {
  const Box3 box = exact.object_box();
  const auto place = [&](const CameraOptions& options, std::optional<Vec3> plane = {}) -> Result<PlacedView> {
    const Result<Camera> camera = Camera::make(box, options, width, height);
    if (!camera) return camera.error();
    return PlacedView{*camera, plane};
  };
  const CameraOptions full = full_view(box);
  if (view.name == "full") return place(full);
  if (view.name == "inside") {
    const CameraOptions options = inside_view(exact);
    if (!options.eye)
      return Error{ErrorCode::kInvalidInput,
                   "no place in its box is empty and sees it; leave out camera inside"};
    return place(options);
  }
  const Result<Camera> camera = Camera::make(box, full, kMaskWidth, kMaskHeight);
  if (!camera) return camera.error();
  const Mask mask = make_mask(exact, *camera);
  const Window window = find_window(mask);
  const auto middle = nearest_hit(mask, window.x, window.y);
  if (!middle)
    return Error{ErrorCode::kInvalidInput, "nothing of it is seen from the front; use camera inside"};
  CameraOptions options = full;
  if (view.name == "cover90") {
    options.look = camera->eye() + camera->ray(window.x, window.y).direction;
    options.fov_degrees = narrowed(kFullFov, window.share);
    return place(options);
  }
  const Ray& ray = mask.rays[*middle];
  const Vec3 at = ray.origin + ray.direction * mask.hits[*middle].t;
  if (view.name == "close") {
    options.eye = at - ray.direction * std::min(kCloseTiles * tile_edge, mask.hits[*middle].t / 2);
    options.look = at;
    return place(options);
  }
  const Vec3 normal = plane_normal(mask, *middle, *camera, kGrazeTiles * tile_edge);
  options = grazing_view(exact, at, normal, view.graze_degrees, tile_edge);
  if (!options.eye)
    return Error{ErrorCode::kInvalidInput,
                 "nothing of it is seen at so low an angle; leave out camera " + view.name};
  return place(options, normal);
}

}  // namespace mesocell
