#include "sdk/shade/render.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kTilePixels = 32;
/// Pixels a side whose rays are cast together, as Caster::first_hits() likes them best.
constexpr std::uint32_t kSquare = 8;
constexpr float kMissDepth = std::numeric_limits<float>::infinity();

struct Mode {
  std::string_view name;
  RenderMode mode;
};
constexpr Mode kModes[] = {{"first-hit", RenderMode::kFirstHit},
                           {"depth", RenderMode::kDepth},
                           {"cell", RenderMode::kCell},
                           {"normal", RenderMode::kNormal},
                           {"color", RenderMode::kColor}};

constexpr Vec3 kSky{0.80, 0.83, 0.87};

void store(std::vector<float>& to, std::size_t pixel, Vec3 v) {
  for (std::size_t c = 0; c < 3; ++c) to[3 * pixel + c] = float(v[c]);
}

/// A color of its own for every label, the same in all instances: hues by the golden angle, three
/// lightnesses.
Vec3 label_color(std::uint32_t label) {
  const double hue = std::fmod(0.618033988749895 * label, 1.0) * 6, value = 0.9 - 0.2 * (label % 3);
  const auto channel = [&](double offset) {
    const double k = std::fmod(hue + offset, 6.0);
    const double low = 0.25;
    return value * (1 - (1 - low) * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
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

namespace {

bool needs_layers(const RenderOptions& options) {
  return options.layers || options.mode == RenderMode::kNormal || options.mode == RenderMode::kColor;
}

/// Renders pixels; what all of them share.
class Renderer {
 public:
  Renderer(const Caster& caster, const Camera& camera, const RenderOptions& options, RenderResult& result)
      : caster_(caster),
        camera_(camera),
        options_(options),
        environment_(options.environment ? *options.environment : Environment(kSky)),
        radiance_(caster, options.lighting, environment_, camera.forward()),
        result_(result) {}

  /// Renders the pixels of [x0, x1) × [y0, y1), at most kSquare a side. Returns how many rays through their
  /// centres hit.
  std::uint64_t square(std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    std::array<Ray, kSquare * kSquare> rays;
    std::array<StreamHit, kSquare * kSquare> hits;
    std::size_t n = 0;
    for (std::uint32_t y = y0; y < y1; ++y)
      for (std::uint32_t x = x0; x < x1; ++x) rays[n++] = camera_.ray(x + 0.5, y + 0.5);
    caster_.first_hits(std::span(rays).first(n), std::span(hits).first(n));
    std::uint64_t found = 0;
    n = 0;
    for (std::uint32_t y = y0; y < y1; ++y)
      for (std::uint32_t x = x0; x < x1; ++x, ++n) {
        pixel(x, y, rays[n], hits[n]);
        found += hits[n].hit();
      }
    return found;
  }

 private:
  void pixel(std::uint32_t x, std::uint32_t y, const Ray& ray, const StreamHit& centre) {
    const std::size_t i = x + std::size_t{options_.width} * y;
    const bool found = centre.hit();
    Hit hit;
    if (found) {
      result_.depth[i] = float(centre.t);
      result_.cell[i] = float(centre.label);
      if (needs_layers(options_) || options_.mode == RenderMode::kFirstHit)
        hit = caster_.details(ray, centre);
      if (needs_layers(options_)) {
        store(result_.normal, i, caster_.shading_normal(hit));
        store(result_.color, i, caster_.color(hit, ray.origin + ray.direction * hit.t));
      }
    }
    switch (options_.mode) {
      case RenderMode::kDepth:
        break;  // needs all depths first
      case RenderMode::kCell:
        if (found) store(result_.rgb, i, label_color(centre.label));
        break;
      case RenderMode::kNormal:
        for (std::size_t c = 0; found && c < 3; ++c)
          result_.rgb[3 * i + c] = 0.5f + 0.5f * result_.normal[3 * i + c];
        break;
      case RenderMode::kColor:
        std::copy_n(result_.color.begin() + std::ptrdiff_t(3 * i), 3,
                    result_.rgb.begin() + std::ptrdiff_t(3 * i));
        break;
      case RenderMode::kFirstHit:
        store(result_.rgb, i, picture(x, y, ray, found, hit));
        break;
    }
  }

  Vec3 picture(std::uint32_t x, std::uint32_t y, const Ray& centre, bool found, const Hit& centre_hit) {
    Rng rng(x + (std::uint64_t{y} << 32));
    if (options_.samples == 1)
      return found ? radiance_.of_hit(centre, centre_hit, rng) : environment_.radiance(centre.direction);
    Vec3 sum;
    for (std::uint32_t s = 0; s < options_.samples; ++s) {
      // The R2 sequence [Roberts 2018]: even at every number of samples.
      const double u = 0.5 + 0.7548776662466927 * s, v = 0.5 + 0.5698402909980532 * s;
      const Ray ray = camera_.ray(x + (u - std::floor(u)), y + (v - std::floor(v)));
      Hit hit;
      sum = sum + (caster_.first_hit(ray, hit) ? radiance_.of_hit(ray, hit, rng)
                                               : environment_.radiance(ray.direction));
    }
    return sum / options_.samples;
  }

  const Caster& caster_;
  const Camera& camera_;
  const RenderOptions& options_;
  Environment environment_;
  Radiance radiance_;
  RenderResult& result_;
};

Status check(const RenderOptions& options) {
  const auto usage = [](const char* text) { return Error{ErrorCode::kUsage, text}; };
  const Lighting& l = options.lighting;
  if (!(l.reflectivity >= 0 && l.reflectivity <= 1)) return usage("the reflectivity is not between 0 and 1");
  if (l.ior != 0 && !(l.ior >= 1 && l.ior <= 10))
    return usage("the index of refraction is not between 1 and 10");
  if (l.bounces > 1000 || l.events > 1000) return usage("more than 1000 bounces are not followed");
  if (l.occlusion_rays > 4096) return usage("more than 4096 rays of occlusion are not cast");
  if (l.light && !(is_finite(*l.light) && length(*l.light) > 0)) return usage("the light has no direction");
  if (options.samples < 1 || options.samples > 4096) return usage("the samples are not between 1 and 4096");
  return {};
}

}  // namespace

Result<RenderResult> render(const Caster& caster, const RenderOptions& options, const Progress* progress) {
  const auto start = std::chrono::steady_clock::now();
  if (const Status status = check(options); !status) return status.error();
  const Result<Camera> camera =
      Camera::make(caster.object_box(), options.camera, options.width, options.height);
  if (!camera) return camera.error();
  RenderResult result;
  result.width = options.width;
  result.height = options.height;
  const std::size_t pixels = std::size_t{options.width} * options.height;
  result.rgb.resize(3 * pixels);
  if (needs_layers(options)) {
    result.normal.resize(3 * pixels);
    result.color.resize(3 * pixels);
  }
  result.cell.resize(pixels);
  result.depth.assign(pixels, kMissDepth);

  Renderer renderer(caster, *camera, options, result);
  const std::uint32_t columns = (options.width + kTilePixels - 1) / kTilePixels;
  const std::uint32_t rows = (options.height + kTilePixels - 1) / kTilePixels;
  std::atomic<std::uint64_t> hits{0};
  const auto render_tile = [&](std::size_t k, unsigned) {
    const std::uint32_t x0 = std::uint32_t(k % columns) * kTilePixels,
                        y0 = std::uint32_t(k / columns) * kTilePixels;
    std::uint64_t tile_hits = 0;
    const std::uint32_t x1 = std::min(x0 + kTilePixels, options.width),
                        y1 = std::min(y0 + kTilePixels, options.height);
    for (std::uint32_t y = y0; y < y1; y += kSquare)
      for (std::uint32_t x = x0; x < x1; x += kSquare)
        tile_hits += renderer.square(x, y, std::min(x + kSquare, x1), std::min(y + kSquare, y1));
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
