#include "sdk/core/srgb.h"

#include <cmath>
#include <limits>

#include "tests/support/catch.h"

using namespace mesocell;

namespace {

/// As the standard says, by the maths library.
double decoded(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }
double encoded(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

}  // namespace

TEST_CASE("linear light of sRGB is that of the standard to some units in the last place") {
  CHECK(srgb_to_linear(std::uint8_t{0}) == 0);
  CHECK(srgb_to_linear(std::uint8_t{255}) == 1);
  for (int k = 1; k < 256; ++k)
    CHECK(srgb_to_linear(std::uint8_t(k)) == Approx(decoded(k / 255.0)).epsilon(1e-15).margin(0));
  // The same bits everywhere.
  CHECK(srgb_to_linear(std::uint8_t{11}) == 0x1.b6a31b5259c98p-9);
  CHECK(srgb_to_linear(std::uint8_t{128}) == 0x1.ba1511e3e632bp-3);
  CHECK(srgb_to_linear(Rgb8{255, 0, 255}) == Vec3{1, 0, 1});
}

TEST_CASE("what is decoded is encoded to itself, and borders lie half-way in sRGB") {
  for (int k = 0; k < 256; ++k) {
    CHECK(linear_to_srgb8(srgb_to_linear(std::uint8_t(k))) == k);
    if (k == 255) break;
    const double border = decoded((k + 0.5) / 255);
    CHECK(linear_to_srgb8(border * (1 - 1e-12)) == k);
    CHECK(linear_to_srgb8(border * (1 + 1e-12)) == k + 1);
  }
  for (int i = 0; i <= 100000; ++i) {
    const double x = i / 100000.0, exact = 255 * encoded(x);
    if (std::abs(exact - std::floor(exact) - 0.5) < 1e-4)
      continue;  // the standard's two pieces do not quite meet
    REQUIRE(int(linear_to_srgb8(x)) == int(std::lround(exact)));
  }
  CHECK(linear_to_srgb8(Vec3{0.2, 1, 0}) == Rgb8{124, 255, 0});
}

TEST_CASE("values out of range are held to it, and no number is black") {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double x : {-kInf, -1.0, -0.0, 1e-300, std::numeric_limits<double>::quiet_NaN()})
    CHECK(linear_to_srgb8(x) == 0);
  for (const double x : {1.0, 1.5, 1e300, kInf}) CHECK(linear_to_srgb8(x) == 255);
}
