#pragma once

#include <array>
#include <cstdint>

#include "sdk/core/vec.h"

namespace mesocell {

/// What a triangle adds to the winding number about p + (ε, ε², ε³), exactly: 1 or -1 if the line from there
/// along -x goes through it, else 0. Of a closed surface the sum over all triangles is its winding number.
[[nodiscard]] std::int32_t crossing(const std::array<Vec3, 3>& v, Vec3 p);

}  // namespace mesocell
