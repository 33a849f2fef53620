#include "sdk/core/portable_math.h"

#include <cmath>
#include <numbers>

namespace mesocell {

double portable_sine(double angle) {
  if (angle > std::numbers::pi) angle -= 2 * std::numbers::pi;
  if (angle < -std::numbers::pi) angle += 2 * std::numbers::pi;
  double sin = 0, term = angle;
  for (int i = 1; i < 40; i += 2) {
    sin += term;
    term *= -angle * angle / ((i + 1) * (i + 2));
  }
  return sin;
}

double portable_power(double base, double exponent) {
  if (base == 0) return 0;
  // base = m · 2^e with m in [√½, √2), exactly.
  int e = 0;
  double m = std::frexp(base, &e);
  if (m < std::numbers::sqrt2 / 2) {
    m *= 2;
    --e;
  }
  // ln m = 2 artanh((m - 1) / (m + 1)), |argument| < 0.172
  const double u = (m - 1) / (m + 1), u2 = u * u;
  double log = 0, power = u;
  for (int k = 1; k < 24; k += 2) {
    log += power / k;
    power *= u2;
  }
  // 2^(exponent · log2 base), whole and broken part by themselves
  const double twos = exponent * (e + 2 * log / std::numbers::ln2), whole = std::nearbyint(twos);
  const double x = (twos - whole) * std::numbers::ln2;
  double result = 0, term = 1;
  for (int k = 1; k < 22; ++k) {
    result += term;
    term *= x / k;
  }
  return whole > 1100 ? HUGE_VAL : whole < -1100 ? 0 : std::ldexp(result, int(whole));
}

}  // namespace mesocell
