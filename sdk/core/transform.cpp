#include "sdk/core/transform.h"

#include <cmath>

namespace mesocell {

std::optional<Transform> Transform::inverse() const {
  const Vec3 columns[3] = {cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])};
  const double determinant = dot(rows[0], columns[0]);
  if (!std::isfinite(1 / determinant)) return std::nullopt;
  Transform inverse;
  for (std::size_t a = 0; a < 3; ++a)
    inverse.rows[a] = Vec3{columns[0][a], columns[1][a], columns[2][a]} / determinant;
  inverse.move = -inverse.direction(move);
  for (const Vec3& v : {inverse.rows[0], inverse.rows[1], inverse.rows[2], inverse.move})
    if (!is_finite(v)) return std::nullopt;
  return inverse;
}

Transform operator*(const Transform& a, const Transform& b) {
  Transform product;
  for (std::size_t r = 0; r < 3; ++r) product.rows[r] = b.transposed(a.rows[r]);
  product.move = a.point(b.move);
  return product;
}

Transform translation(Vec3 by) {
  Transform t;
  t.move = by;
  return t;
}

Transform scaling(Vec3 by) {
  Transform t;
  for (std::size_t a = 0; a < 3; ++a) t.rows[a][a] = by[a];
  return t;
}

Transform rotation(Vec3 axis, double angle) {
  const Vec3 u = normalize(axis);
  const double c = std::cos(angle), s = std::sin(angle);
  Transform t;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 e;
    e[a] = 1;
    // Rodrigues' formula, of the transpose: row a is what the inverse rotation makes of axis a.
    t.rows[a] = e * c - cross(u, e) * s + u * (u[a] * (1 - c));
  }
  return t;
}

}  // namespace mesocell
