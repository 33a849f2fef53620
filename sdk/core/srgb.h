#pragma once

#include <cstdint>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/core/vec.h"

/// Colors in sRGB and in linear light [IEC 61966-2-1]. Both directions are tables made by the compiler
/// without its maths library, so results are the same on every machine.
namespace mesocell MESOCELL_API {

/// A channel in linear light, from 0 to 1.
[[nodiscard]] double srgb_to_linear(std::uint8_t channel);

[[nodiscard]] inline Vec3 srgb_to_linear(const Rgb8& c) {
  return {srgb_to_linear(c[0]), srgb_to_linear(c[1]), srgb_to_linear(c[2])};
}

/// The channel nearest to a value in linear light, by its distance in sRGB; half-way is up. What is below 0
/// or no number becomes 0, what is above 1 becomes 255.
[[nodiscard]] std::uint8_t linear_to_srgb8(double linear);

[[nodiscard]] inline Rgb8 linear_to_srgb8(Vec3 c) {
  return {linear_to_srgb8(c.x), linear_to_srgb8(c.y), linear_to_srgb8(c.z)};
}

}  // namespace mesocell
