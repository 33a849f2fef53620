#pragma once

#include <array>

#include "sdk/core/vec.h"

namespace mesocell {

/// Whether three points are on a line, exactly.
[[nodiscard]] bool collinear(Vec3 a, Vec3 b, Vec3 c);

/// Whether a point is on a closed triangle, exactly.
/// - the triangle's corners are not collinear
[[nodiscard]] bool is_on_triangle(Vec3 p, const std::array<Vec3, 3>& triangle);

/// Whether two closed triangles have a point in common beyond the vertices and the edge that they share by
/// having corners at the same places; exactly, by the signs of determinants. [Guigue, Devillers 2003; Möller
/// 1997 for the order of the tests] Triangles that share all three corners do not: they are duplicates.
/// - neither triangle's corners are collinear
[[nodiscard]] bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace mesocell
