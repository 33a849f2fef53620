#pragma once

#include "sdk/core/vec.h"

/// Exact signs of determinants of doubles, by CGAL's filtered predicates. The source file is the only one of
/// the library that sees CGAL, and of it only the kernel (LGPL).
namespace mesocell {

/// Sign of |q - p, r - p|: +1 if p, q, r turn counter-clockwise, 0 if they are collinear, exactly.
[[nodiscard]] int orientation_2d(double px, double py, double qx, double qy, double rx, double ry);

/// Sign of (b - a) × (c - a) · (p - a): +1 if p is on the side from which a, b, c turn counter-clockwise, 0
/// if the four are coplanar, exactly.
[[nodiscard]] int orientation_3d(Vec3 a, Vec3 b, Vec3 c, Vec3 p);

}  // namespace mesocell
