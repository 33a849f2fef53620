#pragma once

#include <cstdint>

#include "sdk/core/vec.h"

namespace mesocell {

/// Gradient noise on the torus [Perlin 2002], in about [-1, 1]. `p` in periods: it repeats at whole numbers on every
/// axis. `period`: lattice cells in a period, at least 1. Only sums and products, so it is the same everywhere.
[[nodiscard]] double tileable_noise(Vec3 p, std::uint32_t period, std::uint64_t seed);

/// Octaves of it, each of twice the period and half the amplitude; in about [-1, 1].
[[nodiscard]] double tileable_turbulence(Vec3 p, std::uint32_t period, std::uint32_t octaves, std::uint64_t seed);

}  // namespace mesocell
