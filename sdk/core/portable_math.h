#pragma once

#include "format/api.h"

/// Functions whose last digits are the same on every machine, which those of its own library are not: for what ends
/// up in files.
namespace mesocell MESOCELL_API {

/// The sine of an angle in [-2π, 2π], radians, to 1e-15.
[[nodiscard]] double portable_sine(double angle);

/// `base` to the power of `exponent`, to 1e-14 of it; the base is finite and not negative, the exponent in
/// [0.01, 100].
[[nodiscard]] double portable_power(double base, double exponent);

}  // namespace mesocell
