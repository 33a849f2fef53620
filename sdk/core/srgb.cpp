#include "sdk/core/srgb.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace mesocell {
namespace {

/// The fifth root of a number in (0, 1], by Newton's iteration from above.
constexpr double fifth_root(double q) {
  double r = 1;
  for (int i = 0; i < 40; ++i) {
    const double r2 = r * r, r4 = r2 * r2;
    r -= (r4 * r - q) / (5 * r4);
  }
  return r;
}

/// Linear light of an sRGB value in [0, 1].
constexpr double decode(double s) {
  if (s <= 0.04045) return s / 12.92;
  const double base = (s + 0.055) / 1.055, square = base * base;
  return square * fifth_root(square);  // base to the power of 2.4
}

constexpr std::array<double, 256> kLinear = [] {
  std::array<double, 256> table{};
  for (std::size_t k = 0; k < 256; ++k) table[k] = decode(double(k) / 255);
  return table;
}();

/// The least linear value that is nearer to channel k + 1 than to k.
constexpr std::array<double, 255> kBorders = [] {
  std::array<double, 255> table{};
  for (std::size_t k = 0; k < 255; ++k) table[k] = decode((double(k) + 0.5) / 255);
  return table;
}();

}  // namespace

double srgb_to_linear(std::uint8_t channel) { return kLinear[channel]; }

std::uint8_t linear_to_srgb8(double linear) {
  if (!(linear > 0)) return 0;
  return std::uint8_t(std::upper_bound(kBorders.begin(), kBorders.end(), linear) - kBorders.begin());
}

}  // namespace mesocell
