#include "sdk/core/portable_math.h"

#include <cmath>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"

using namespace mesocell;

TEST_CASE("sines are right to the last digits") {
  for (int k = -1000; k <= 1000; ++k) {
    const double x = 6.28 * k / 1000;
    CHECK(std::abs(portable_sine(x) - std::sin(x)) < 1e-15);
  }
}

TEST_CASE("powers are right to the last digits") {
  Rng rng(3);
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const double base = std::exp2(rng.uniform(-20, 20)), exponent = rng.uniform(0.01, 10);
    const double power = std::pow(base, exponent);
    worst = std::max(worst, std::abs(portable_power(base, exponent) / power - 1));
  }
  CHECK(worst < 1e-13);
  CHECK(portable_power(0, 2) == 0);
  CHECK(portable_power(1, 1.737) == 1);
  CHECK(portable_power(0.25, 0.5) == Approx(0.5).epsilon(1e-15));
}
