#pragma once

#include <array>

#include "sdk/core/vec.h"

namespace mesocell {

/// Whether the closed triangle a b c and the closed box [low, high] have a point in common, exactly: touching
/// in a single point suffices. The triangle may be degenerate. Corners of the box are whole numbers below
/// 2^53.
[[nodiscard]] bool triangle_meets_box(const std::array<Vec3, 3>& triangle, const Vec3& low, const Vec3& high);

}  // namespace mesocell
