#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "sdk/core/vec.h"

namespace mesocell {

/// An affine map of space: x -> linear · x + move.
struct Transform {
  std::array<Vec3, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< of the linear part
  Vec3 move;

  [[nodiscard]] Vec3 direction(Vec3 d) const { return {dot(rows[0], d), dot(rows[1], d), dot(rows[2], d)}; }
  [[nodiscard]] Vec3 point(Vec3 p) const { return direction(p) + move; }
  /// The linear part's transpose times `n`: where this is an inverse, normals of surfaces go by it.
  [[nodiscard]] Vec3 transposed(Vec3 n) const { return rows[0] * n.x + rows[1] * n.y + rows[2] * n.z; }
  /// None if the linear part is singular, or not finite.
  [[nodiscard]] std::optional<Transform> inverse() const;
};

/// First `b`, then `a`.
[[nodiscard]] Transform operator*(const Transform& a, const Transform& b);

[[nodiscard]] Transform translation(Vec3 by);
[[nodiscard]] Transform scaling(Vec3 by);
/// Counter-clockwise about an axis through the origin, seen from its tip; radians. The axis is not zero.
[[nodiscard]] Transform rotation(Vec3 axis, double angle);

}  // namespace mesocell
