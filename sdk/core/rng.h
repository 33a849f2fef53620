#pragma once

#include <cstdint>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// SplitMix64 [Steele, Lea, Flood 2014]: the same numbers on every machine, always from an explicit seed.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// The upper `bits` (1…64) of the next number.
  std::uint64_t bits(unsigned bits) { return next() >> (64 - bits); }
  /// Uniform in [0, 1), 53 bits.
  double uniform() { return double(bits(53)) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in [0, n), n > 0, by multiply-shift; the bias is below n / 2³².
  std::uint32_t below(std::uint32_t n) { return std::uint32_t(bits(32) * n >> 32); }

 private:
  std::uint64_t state_;
};

}  // namespace mesocell
