#include "sdk/surface/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "sdk/core/rng.h"
#include "sdk/surface/instance_colors.h"
#include "sdk/surface/noise.h"
#include "sdk/surface/surface_colors.h"

namespace mesocell {
namespace {

/// A smooth wave of period 1 between 0 and 1, as a polynomial: the maths library's sine may differ by
/// machine.
double wave(double x) {
  const double f = x - std::floor(x), t = f < 0.5 ? 2 * f : 2 - 2 * f;
  return t * t * (3 - 2 * t);
}

using Color = std::array<double, 3>;
Color blend(const Color& a, const Color& b, double t) {
  t = std::clamp(t, 0.0, 1.0);
  return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t};
}
Rgb8 to_rgb8(const Color& c) {
  Rgb8 rgb{};
  for (std::size_t k = 0; k < 3; ++k) rgb[k] = std::uint8_t(std::clamp(c[k], 0.0, 1.0) * 255 + 0.5);
  return rgb;
}

/// Pale stone with dark veins, which are bent by noise.
Color marble(Vec3 p, std::uint64_t seed) {
  const double bend = tileable_turbulence(p, 3, 4, seed);
  const double vein = wave(p.x + p.y + 1.8 * bend);
  return blend({0.93, 0.91, 0.88}, {0.33, 0.32, 0.38}, (1 - vein) * (1 - vein) * (0.65 + 0.5 * bend));
}

/// Rings around two axes a period, with fibres along z.
Color wood(Vec3 p, std::uint64_t seed) {
  const double bend = 0.35 * tileable_turbulence({p.x, p.y, p.z}, 2, 2, seed);
  const double ring = wave(4 * (wave(p.x) + wave(p.y)) + 2 * bend);
  const double fibre = 0.12 * tileable_noise({p.x, p.y, p.z}, 24, seed + 9);
  return blend({0.80, 0.58, 0.34}, {0.44, 0.25, 0.12}, ring * 0.85 + fibre);
}

/// Grains of three colors.
Color stone(Vec3 p, std::uint64_t seed) {
  const double large = tileable_turbulence(p, 4, 3, seed), small = tileable_noise(p, 20, seed + 7);
  const Color base = blend({0.62, 0.58, 0.55}, {0.46, 0.43, 0.44}, 0.5 + 0.9 * large);
  return small > 0.22 ? blend(base, {0.82, 0.79, 0.76}, (small - 0.22) * 6)
                      : blend(base, {0.20, 0.19, 0.21}, (-small - 0.25) * 6);
}

struct Solid {
  std::string_view name, help;
  Color (*at)(Vec3, std::uint64_t);
};
constexpr Solid kSolids[] = {
    {"marble", "pale stone with veins", marble},
    {"wood", "rings and fibres", wood},
    {"stone", "grains of three colors", stone},
};

/// A bright color of any hue.
Rgb8 random_color(Rng& rng) {
  const double hue = 6 * rng.uniform(), value = rng.uniform(0.65, 0.95), low = rng.uniform(0.25, 0.55);
  Color c{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double h = std::fmod(hue + 2 * double(k), 6.0);
    c[k] = value * (low + (1 - low) * std::clamp(std::abs(h - 3) - 1, 0.0, 1.0));
  }
  return to_rgb8(c);
}

}  // namespace

Result<Colors> make_colors(const Recipe& recipe, std::uint32_t cell_count) {
  const auto seed = whole_option(recipe, "seed", 1, 0, ~std::uint64_t{0});
  if (!seed) return seed.error();
  Colors colors;
  if (recipe.name == "cells") {
    constexpr std::string_view names[] = {"seed"};
    if (const Status status = check_options(recipe, "color", names); !status) return status.error();
    Rng rng(*seed);
    ColorList& cells = colors.cells.emplace();
    for (std::uint32_t c = 0; c < cell_count; ++c) cells.colors.push_back(random_color(rng));
    return colors;
  }
  std::string names;
  for (const Solid& solid : kSolids) {
    names += std::string(solid.name) + ", ";
    if (solid.name != recipe.name) continue;
    constexpr std::string_view options[] = {"resolution", "seed"};
    if (const Status status = check_options(recipe, "color", options); !status) return status.error();
    const auto resolution = whole_option(recipe, "resolution", 64, 1, 256);
    if (!resolution) return resolution.error();
    const std::uint32_t n = std::uint32_t(*resolution);
    ColorMap map;
    map.resolution = {n, n, n};
    map.voxels.reserve(std::size_t{n} * n * n);
    for (std::uint32_t z = 0; z < n; ++z)
      for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x)
          map.voxels.push_back(to_rgb8(solid.at({(x + 0.5) / n, (y + 0.5) / n, (z + 0.5) / n}, *seed)));
    colors.map = std::move(map);
    return colors;
  }
  return Error{ErrorCode::kUsage, "unknown color '" + recipe.name + "'; there are: " + names + "cells"};
}

Status apply_colors(Colors colors, CellObject& object, unsigned threads, const Progress* progress) {
  std::optional<ColorList> instances;
  std::optional<SurfaceColors> surface;
  if (colors.field) {
    const Result<ColorField> field = colors.field(object, threads, progress);
    if (!field) return field.error();
    Result<std::vector<Rgb8>> made = make_instance_colors(object, *field, threads, progress);
    if (!made) return made.error();
    instances = ColorList{std::move(*made)};
    if (colors.surface_resolution) {
      auto baked = make_surface_colors(object, *field, *colors.surface_resolution, threads, progress);
      if (!baked) return baked.error();
      surface = std::move(*baked);
    }
  }
  object.color = std::move(colors.map);
  object.cell_colors = std::move(colors.cells);
  object.instance_colors = std::move(instances);
  object.surface_colors = std::move(surface);
  return {};
}

std::string color_recipes_help() {
  std::string text;
  for (const Solid& solid : kSolids)
    text += std::string(solid.name) + ":resolution=64,seed=1   " + std::string(solid.help) + "\n";
  return text +
         "cells:seed=1   a random color for each cell\n"
         "resolution: color voxels per axis of the tile, 1…256\n";
}

WrapCheck check_wrap(const ColorMap& map) {
  const Index3& n = map.resolution;
  const std::size_t stride[3] = {1, n[0], std::size_t{n[0]} * n[1]};
  // Of the planes of voxels along each axis: steps from the plane to the next, and second differences of it
  // and the two after it.
  std::array<std::vector<std::uint64_t>, 3> step, bend;
  for (std::size_t a = 0; a < 3; ++a) {
    step[a].resize(n[a]);
    bend[a].resize(n[a]);
  }
  std::size_t i = 0;
  std::array<std::uint32_t, 3> at{};
  for (at[2] = 0; at[2] < n[2]; ++at[2])
    for (at[1] = 0; at[1] < n[1]; ++at[1])
      for (at[0] = 0; at[0] < n[0]; ++at[0], ++i)
        for (std::size_t a = 0; a < 3; ++a) {
          const auto after = [&](std::uint32_t by) -> const Rgb8& {
            return map.voxels[i - at[a] * stride[a] + (at[a] + by) % n[a] * stride[a]];
          };
          const Rgb8 &p = map.voxels[i], &q = after(1), &r = after(2);
          for (std::size_t c = 0; c < 3; ++c) {
            step[a][at[a]] += std::uint64_t(std::abs(q[c] - p[c]));
            bend[a][at[a]] += std::uint64_t(std::abs(r[c] - 2 * q[c] + p[c]));
          }
        }
  const auto ratio = [](std::uint64_t across, std::uint64_t within) {
    return within > 0 ? double(across) / double(within) : across > 0 ? 1e9 : 1.0;
  };
  WrapCheck check;
  for (std::size_t a = 0; a < 3; ++a) {
    if (n[a] < WrapCheck::kLeastVoxels) continue;
    // The last step and the last two second differences reach across the border.
    std::uint64_t most_step = 0, most_bend = 0;
    for (std::size_t k = 0; k + 1 < n[a]; ++k) most_step = std::max(most_step, step[a][k]);
    for (std::size_t k = 0; k + 3 < n[a]; ++k) most_bend = std::max(most_bend, bend[a][k] + bend[a][k + 1]);
    check.value_ratio = std::max(check.value_ratio, ratio(step[a].back(), most_step));
    check.gradient_ratio =
        std::max(check.gradient_ratio, ratio(bend[a][n[a] - 2] + bend[a][n[a] - 1], most_bend));
  }
  return check;
}

}  // namespace mesocell
