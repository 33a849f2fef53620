#include "sdk/surface/color.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <string>

#include "sdk/surface/noise.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

ColorMap solid(const std::string& name, std::uint32_t resolution, int seed) {
  const Result<Colors> colors = make_colors(
      *parse_recipe(name + ":resolution=" + std::to_string(resolution) + ",seed=" + std::to_string(seed)), 8);
  REQUIRE(colors.ok());
  REQUIRE(colors->map.has_value());
  return *colors->map;
}

}  // namespace

TEST_CASE("noise repeats, is smooth and stays in range") {
  for (const std::uint32_t period : {1u, 2u, 5u, 16u})
    for (int k = 0; k < 200; ++k) {
      const Vec3 p{k * 0.137, k * 0.071, k * 0.253};
      const double n = tileable_noise(p, period, 3);
      CHECK(std::abs(n) <= 1.1);
      CHECK(tileable_noise(p + Vec3{1, -2, 3}, period, 3) == Approx(n).margin(1e-9));
      CHECK(std::abs(tileable_noise(p + Vec3{1e-6, 0, 0}, period, 3) - n) < 1e-4);
    }
  // Across the border it is as smooth as anywhere.
  CHECK(std::abs(tileable_noise({0.9999999, 0.3, 0.4}, 4, 1) - tileable_noise({0.0000001, 0.3, 0.4}, 4, 1)) <
        1e-5);
  CHECK(tileable_noise({0.3, 0.3, 0.4}, 4, 1) != tileable_noise({0.3, 0.3, 0.4}, 4, 2));
}

TEST_CASE("procedural solids tile without a seam in value and gradient") {
  double worst_value = 0, worst_gradient = 0;
  for (const char* name : {"marble", "wood", "stone"})
    for (const std::uint32_t n : {8u, 16u, 32u, 48u})
      for (const int seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
        if (n > 16 && seed > 3) continue;
        const ColorMap map = solid(name, n, seed);
        CHECK(map.voxels.size() == std::size_t{n} * n * n);
        const WrapCheck check = check_wrap(map);
        INFO(name << ":resolution=" << n << ",seed=" << seed << ": " << check.value_ratio << ", "
                  << check.gradient_ratio);
        CHECK_FALSE(check.has_seam());
        worst_value = std::max(worst_value, check.value_ratio);
        worst_gradient = std::max(worst_gradient, check.gradient_ratio);
        if (n >= 48) CHECK(std::set<Rgb8>(map.voxels.begin(), map.voxels.end()).size() > 100);
      }
  std::printf("Solids that tile: ratios of at most %.3f in value, %.3f in gradient\n", worst_value,
              worst_gradient);
}

TEST_CASE("the wrap check sees that a solid was cut") {
  double least = 1e9;
  for (const char* name : {"marble", "wood", "stone"})
    for (const int seed : {1, 2, 3}) {
      constexpr std::uint32_t n = 64, part = 57;
      const ColorMap whole = solid(name, n, seed);
      ColorMap cut{{part, n, n}, {}};
      for (std::uint32_t i = 0; i < n * n * n; ++i)
        if (i % n < part) cut.voxels.push_back(whole.voxels[i]);
      const WrapCheck check = check_wrap(cut);
      INFO(name << " " << seed << ": " << check.value_ratio << ", " << check.gradient_ratio);
      CHECK(check.has_seam());
      least = std::min(least, std::max(check.value_ratio, check.gradient_ratio));
    }
  std::printf("Solids of 64 voxels cut to 57: the greater of the two ratios is at least %.3f\n", least);
}

TEST_CASE("the wrap check sees a seam of value, and one of gradient alone") {
  ColorMap ramp{{32, 8, 8}, {}}, tent{{32, 8, 8}, {}};
  for (std::uint32_t i = 0; i < 32 * 64; ++i) {
    const std::uint32_t x = i % 32;
    ramp.voxels.push_back({std::uint8_t(8 * x), 0, 0});
    // Rises and falls smoothly within, but has a kink at the border.
    const double u = (x + 0.5) / 32;
    tent.voxels.push_back({std::uint8_t(1000 * u * (1 - u)), 0, 0});
  }
  CHECK(check_wrap(ramp).value_ratio == 31);
  CHECK(check_wrap(tent).value_ratio < WrapCheck::kSeam);
  CHECK(check_wrap(tent).gradient_ratio > 4);
  CHECK(check_wrap(tent).has_seam());
}

TEST_CASE("the wrap check takes no hard edge at the border for a seam if there are such within") {
  ColorMap bricks{{32, 32, 32}, {}}, flat{{16, 16, 16}, std::vector<Rgb8>(4096, {9, 9, 9})}, lines = bricks;
  for (std::uint32_t i = 0; i < 32 * 32 * 32; ++i) {
    const bool mortar = i % 8 == 0 || i / 32 % 8 == 0 || i / 1024 % 8 == 0;
    bricks.voxels.push_back(mortar ? Rgb8{220, 220, 220} : Rgb8{140, 60, 40});
    lines.voxels.push_back(i % 32 == 31 ? Rgb8{220, 220, 220} : Rgb8{140, 60, 40});
  }
  CHECK_FALSE(check_wrap(bricks).has_seam());
  CHECK_FALSE(check_wrap(flat).has_seam());
  CHECK(check_wrap(flat).value_ratio == 1);
  // A line as thick as a voxel has two edges, of which one is at the border.
  CHECK(check_wrap(lines).value_ratio == 1);
}

TEST_CASE("cells get colors of their own") {
  const Result<Colors> colors = make_colors(*parse_recipe("cells:seed=4"), 100);
  REQUIRE(colors.ok());
  CHECK_FALSE(colors->map.has_value());
  REQUIRE(colors->cells.has_value());
  const std::vector<Rgb8>& cells = colors->cells->colors;
  REQUIRE(cells.size() == 100);
  CHECK(std::set<Rgb8>(cells.begin(), cells.end()).size() > 95);
  CHECK(make_colors(*parse_recipe("cells:seed=4"), 100)->cells == colors->cells);
}

TEST_CASE("a wrong color recipe is a usage error") {
  for (const char* bad : {"granite", "marble:cells=3", "marble:resolution=0", "marble:resolution=500",
                          "cells:resolution=4", "wood:seed=-1", "marble:seed=x"}) {
    INFO(bad);
    const Result<Colors> colors = make_colors(*parse_recipe(bad), 8);
    REQUIRE_FALSE(colors.ok());
    CHECK(colors.error().code == ErrorCode::kUsage);
  }
}
