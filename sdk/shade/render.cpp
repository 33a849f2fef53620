#include "sdk/shade/render.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kTilePixels = 32;
constexpr float kMissDepth = std::numeric_limits<float>::infinity();

struct Mode {
  std::string_view name;
  RenderMode mode;
};
constexpr Mode kModes[] = {
    {"first-hit", RenderMode::kFirstHit}, {"depth", RenderMode::kDepth}, {"cell", RenderMode::kCell}};

using Color = std::array<float, 3>;
constexpr Color kBackground{0.80f, 0.83f, 0.87f};
constexpr Color kMaterial{0.66f, 0.62f, 0.55f};

Color scaled(const Color& c, double s) { return {float(c[0] * s), float(c[1] * s), float(c[2] * s)}; }

/// Diffuse light of a gray material: a key light from above on the viewer's left, a weak one from the viewer,
/// and a sky that is brighter above.
Color shade(Vec3 normal, const Camera& camera) {
  const Vec3 toward = -camera.forward();
  const Vec3 key =
      normalize(normalize(cross(camera.forward(), Vec3{0, 1, 0})) * -0.6 + Vec3{0, 0.9, 0} + toward * 0.7);
  const double light = 0.72 * std::max(0.0, dot(normal, key)) + 0.18 * std::max(0.0, dot(normal, toward)) +
                       0.10 + 0.08 * (0.5 + 0.5 * normal.y);
  return scaled(kMaterial, light);
}

/// A color of its own for every label, the same in all instances: hues by the golden angle, three
/// lightnesses.
Color label_color(std::uint32_t label) {
  const double hue = std::fmod(0.618033988749895 * label, 1.0) * 6, value = 0.9 - 0.2 * (label % 3);
  const auto channel = [&](double offset) {
    const double k = std::fmod(hue + offset, 6.0);
    const double low = 0.25;
    return float(value * (1 - (1 - low) * std::clamp(std::min(k, 4 - k), 0.0, 1.0)));
  };
  return {channel(5), channel(3), channel(1)};
}

/// Depth as light: the nearest hit is white, the farthest dark, misses black.
void depth_picture(RenderResult& result) {
  float near = kMissDepth, far = 0;
  for (const float d : result.depth)
    if (d < kMissDepth) {
      near = std::min(near, d);
      far = std::max(far, d);
    }
  for (std::size_t i = 0; i < result.depth.size(); ++i) {
    const float d = result.depth[i];
    const float light = d == kMissDepth ? 0.0f : far > near ? 1.0f - 0.95f * (d - near) / (far - near) : 1.0f;
    for (std::size_t c = 0; c < 3; ++c) result.rgb[3 * i + c] = light;
  }
}

}  // namespace

Result<RenderMode> parse_render_mode(std::string_view text) {
  std::string names;
  for (const Mode& m : kModes) {
    if (m.name == text) return m.mode;
    names += (names.empty() ? "" : ", ") + std::string(m.name);
  }
  return Error{ErrorCode::kUsage, "unknown mode '" + std::string(text) + "'; there are: " + names};
}

Result<RenderResult> render(const Caster& caster, const RenderOptions& options, const Progress* progress) {
  const auto start = std::chrono::steady_clock::now();
  const Result<Camera> camera =
      Camera::make(caster.object_box(), options.camera, options.width, options.height);
  if (!camera) return camera.error();
  RenderResult result;
  result.width = options.width;
  result.height = options.height;
  const std::size_t pixels = std::size_t{options.width} * options.height;
  result.rgb.resize(3 * pixels);
  result.depth.assign(pixels, kMissDepth);

  const std::uint32_t columns = (options.width + kTilePixels - 1) / kTilePixels;
  const std::uint32_t rows = (options.height + kTilePixels - 1) / kTilePixels;
  std::atomic<std::uint64_t> hits{0};
  const auto render_tile = [&](std::size_t k, unsigned) {
    const std::uint32_t x0 = std::uint32_t(k % columns) * kTilePixels,
                        y0 = std::uint32_t(k / columns) * kTilePixels;
    std::uint64_t tile_hits = 0;
    for (std::uint32_t y = y0; y < std::min(y0 + kTilePixels, options.height); ++y)
      for (std::uint32_t x = x0; x < std::min(x0 + kTilePixels, options.width); ++x) {
        const std::size_t i = x + std::size_t{options.width} * y;
        Hit hit;
        Color color = options.mode == RenderMode::kFirstHit ? kBackground : Color{};
        if (caster.first_hit(camera->ray(x + 0.5, y + 0.5), hit)) {
          ++tile_hits;
          result.depth[i] = float(hit.t);
          if (options.mode == RenderMode::kFirstHit) color = shade(caster.shading_normal(hit), *camera);
          if (options.mode == RenderMode::kCell) color = label_color(hit.label);
        }
        std::copy(color.begin(), color.end(), result.rgb.begin() + std::ptrdiff_t(3 * i));
      }
    hits += tile_hits;
  };
  if (!parallel_for(std::size_t{columns} * rows, options.threads, render_tile, progress, "render"))
    return Error{ErrorCode::kCancelled, "cancelled"};
  if (options.mode == RenderMode::kDepth) depth_picture(result);
  result.rays = pixels;
  result.hits = hits;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace mesocell
