#include "converters/image/srgb.h"

#include <algorithm>
#include <array>

namespace mesocell {
namespace {

/// x^2.4 for x in (0, 1], without the maths library, whose powers may differ by machine: x² (x^(1/5))².
double power_2_4(double x) {
  double root = 1;
  // From above, Newton's steps for root⁵ = x only fall; 64 are more than x > 0.05 needs.
  for (int k = 0; k < 64; ++k) {
    const double r4 = root * root * root * root;
    root -= (r4 * root - x) / (5 * r4);
  }
  return x * x * root * root;
}

/// The least linear values that are nearer to 1, 2, … 255 than to the value before.
std::array<double, 255> make_thresholds() {
  std::array<double, 255> thresholds{};
  for (std::size_t k = 0; k < 255; ++k) {
    const double s = (double(k) + 0.5) / 255;
    thresholds[k] = s <= 0.04045 ? s / 12.92 : power_2_4((s + 0.055) / 1.055);
  }
  return thresholds;
}

}  // namespace

std::uint8_t encode_srgb(double linear) {
  static const std::array<double, 255> thresholds = make_thresholds();
  if (!(linear > 0)) return 0;
  return std::uint8_t(std::upper_bound(thresholds.begin(), thresholds.end(), linear) - thresholds.begin());
}

}  // namespace mesocell
