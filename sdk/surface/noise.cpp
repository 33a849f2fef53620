#include "sdk/surface/noise.h"

#include <cmath>

namespace mesocell {
namespace {

/// A well-mixed number for a lattice point.
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The product of an offset with one of the twelve directions to the middles of a cube's edges.
double slope(std::uint64_t hash, double x, double y, double z) {
  const std::uint64_t axis = hash % 3;
  const double u = axis == 0 ? y : x, v = axis == 2 ? y : z;
  return (hash & 16 ? -u : u) + (hash & 32 ? -v : v);
}

double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
double blend(double a, double b, double t) { return a + (b - a) * t; }

}  // namespace

double tileable_noise(Vec3 p, std::uint32_t period, std::uint64_t seed) {
  std::uint64_t low[3], high[3];
  double f[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = (p[a] - std::floor(p[a])) * period, cell = std::floor(x);
    low[a] = std::uint64_t(cell) % period;
    high[a] = (low[a] + 1) % period;
    f[a] = x - cell;
  }
  const auto corner = [&](std::uint64_t i, std::uint64_t j, std::uint64_t k, double x, double y, double z) {
    return slope(mix(mix(mix(seed + 0x9e3779b97f4a7c15u * (i + 1)) + j) + k), x, y, z);
  };
  const double u = fade(f[0]), v = fade(f[1]), w = fade(f[2]);
  double plane[2];
  for (int k = 0; k < 2; ++k) {
    const std::uint64_t z = k ? high[2] : low[2];
    const double fz = f[2] - k;
    plane[k] = blend(blend(corner(low[0], low[1], z, f[0], f[1], fz), corner(high[0], low[1], z, f[0] - 1, f[1], fz), u),
                     blend(corner(low[0], high[1], z, f[0], f[1] - 1, fz),
                           corner(high[0], high[1], z, f[0] - 1, f[1] - 1, fz), u),
                     v);
  }
  return blend(plane[0], plane[1], w);
}

double tileable_turbulence(Vec3 p, std::uint32_t period, std::uint32_t octaves, std::uint64_t seed) {
  double sum = 0, amplitude = 1, total = 0;
  for (std::uint32_t o = 0; o < octaves; ++o) {
    sum += amplitude * tileable_noise(p, period, seed + o);
    total += amplitude;
    amplitude /= 2;
    period *= 2;
  }
  return sum / total;
}

}  // namespace mesocell
