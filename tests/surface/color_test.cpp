#include "sdk/surface/color.h"

#include <set>

#include "sdk/surface/noise.h"
#include "tests/support/catch.h"

using namespace mesocell;

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
  CHECK(std::abs(tileable_noise({0.9999999, 0.3, 0.4}, 4, 1) - tileable_noise({0.0000001, 0.3, 0.4}, 4, 1)) < 1e-5);
  CHECK(tileable_noise({0.3, 0.3, 0.4}, 4, 1) != tileable_noise({0.3, 0.3, 0.4}, 4, 2));
}

TEST_CASE("procedural solids tile without a seam in value and gradient") {
  for (const char* name : {"marble", "wood", "stone"}) {
    INFO(name);
    const Result<Colors> colors = make_colors(*parse_recipe(std::string(name) + ":resolution=48,seed=3"), 8);
    REQUIRE(colors.ok());
    REQUIRE(colors->map.has_value());
    CHECK(colors->map->voxels.size() == 48 * 48 * 48);
    const WrapCheck check = check_wrap(*colors->map);
    CHECK(check.value_ratio < 1.5);
    CHECK(check.gradient_ratio < 1.5);
    CHECK(std::set<Rgb8>(colors->map->voxels.begin(), colors->map->voxels.end()).size() > 100);
  }
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
  CHECK(check_wrap(ramp).value_ratio > 10);
  CHECK(check_wrap(tent).value_ratio < 2.5);
  CHECK(check_wrap(tent).gradient_ratio > 4);
}

TEST_CASE("cells get colors of their own") {
  const Result<Colors> colors = make_colors(*parse_recipe("cells:seed=4"), 100);
  REQUIRE(colors.ok());
  CHECK_FALSE(colors->map.has_value());
  REQUIRE(colors->cells.size() == 100);
  CHECK(std::set<Rgb8>(colors->cells.begin(), colors->cells.end()).size() > 95);
  CHECK(make_colors(*parse_recipe("cells:seed=4"), 100)->cells == colors->cells);
}

TEST_CASE("a wrong color recipe is a usage error") {
  for (const char* bad : {"granite", "marble:cells=3", "marble:resolution=0", "marble:resolution=500", "cells:resolution=4",
                          "wood:seed=-1", "marble:seed=x"}) {
    INFO(bad);
    const Result<Colors> colors = make_colors(*parse_recipe(bad), 8);
    REQUIRE_FALSE(colors.ok());
    CHECK(colors.error().code == ErrorCode::kUsage);
  }
}
