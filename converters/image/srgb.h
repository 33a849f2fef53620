#pragma once

#include <cstdint>

namespace mesocell {

/// Linear light to the nearest 8-bit sRGB value [IEC 61966-2-1]: 0 for NaN and what is below 0, 255 for what
/// is above 1. The same on every machine.
[[nodiscard]] std::uint8_t encode_srgb(double linear);

}  // namespace mesocell
