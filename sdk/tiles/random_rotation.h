#pragma once

#include <array>

#include "sdk/core/rng.h"

namespace mesocell {

/// A rotation matrix, by rows.
using Rotation = std::array<double, 9>;

/// A rotation drawn uniformly. Made without functions of the maths library, so it is the same everywhere.
[[nodiscard]] inline Rotation random_rotation(Rng& rng) {
  // A uniform unit quaternion: a point of the 4-ball; dividing by its square spares the root.
  double a, b, c, d, n;
  do {
    a = rng.uniform(-1, 1);
    b = rng.uniform(-1, 1);
    c = rng.uniform(-1, 1);
    d = rng.uniform(-1, 1);
    n = a * a + b * b + c * c + d * d;
  } while (n > 1 || n < 0.01);
  return {(a * a + b * b - c * c - d * d) / n,
          2 * (b * c - a * d) / n,
          2 * (b * d + a * c) / n,
          2 * (b * c + a * d) / n,
          (a * a - b * b + c * c - d * d) / n,
          2 * (c * d - a * b) / n,
          2 * (b * d - a * c) / n,
          2 * (c * d + a * b) / n,
          (a * a - b * b - c * c + d * d) / n};
}

}  // namespace mesocell
