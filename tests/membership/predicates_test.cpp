#include "sdk/membership/predicates.h"

#include <cmath>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"

using namespace mesocell;

// The determinants of 26-bit integers fit 128-bit integers, which know no rounding.
__extension__ typedef __int128 Wide;

namespace {
int sign(Wide x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
}  // namespace

TEST_CASE("orientation in the plane is exact where rounding would decide") {
  Rng rng(1);
  int zeros = 0;
  for (int k = 0; k < 100000; ++k) {
    // Nearly collinear points: two far ones and one near their line.
    const std::int64_t px = rng.below(1 << 26), py = rng.below(1 << 26);
    const std::int64_t dx = rng.below(1 << 20) + 1, dy = rng.below(1 << 20) + 1;
    const std::int64_t qx = px + 31 * dx, qy = py + 31 * dy;
    const std::int64_t rx = px + 7 * dx + rng.below(2), ry = py + 7 * dy + rng.below(2);
    const int expected = sign(Wide(qx - px) * (ry - py) - Wide(qy - py) * (rx - px));
    zeros += expected == 0;
    const double s = std::ldexp(1.0, -int(rng.below(60)));
    REQUIRE(orientation_2d(double(px) * s, double(py) * s, double(qx) * s, double(qy) * s, double(rx) * s,
                           double(ry) * s) == expected);
  }
  CHECK(zeros > 1000);
}

TEST_CASE("orientation in space is exact where rounding would decide") {
  Rng rng(2);
  int zeros = 0;
  for (int k = 0; k < 100000; ++k) {
    std::int64_t a[3], u[3], v[3], p[3];
    for (int i = 0; i < 3; ++i) {
      a[i] = rng.below(1 << 26);
      u[i] = std::int64_t(rng.below(1 << 20)) - (1 << 19);
      v[i] = std::int64_t(rng.below(1 << 20)) - (1 << 19);
      p[i] = 3 * u[i] - 5 * v[i] + (rng.below(8) == 0);
    }
    const Wide expected = Wide(u[0]) * (Wide(v[1]) * p[2] - Wide(v[2]) * p[1]) -
                          Wide(u[1]) * (Wide(v[0]) * p[2] - Wide(v[2]) * p[0]) +
                          Wide(u[2]) * (Wide(v[0]) * p[1] - Wide(v[1]) * p[0]);
    zeros += expected == 0;
    const auto at = [&](const std::int64_t* d) {
      return Vec3{double(a[0] + d[0]), double(a[1] + d[1]), double(a[2] + d[2])};
    };
    const std::int64_t none[3] = {0, 0, 0};
    REQUIRE(orientation_3d(at(none), at(u), at(v), at(p)) == sign(expected));
  }
  CHECK(zeros > 1000);
}
