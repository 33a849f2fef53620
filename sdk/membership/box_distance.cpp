#include "sdk/membership/box_distance.h"

#include <algorithm>
#include <cmath>

namespace mesocell {

double squared_distance(const Box3& a, const Box3& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({0.0, a.min[k] - b.max[k], b.min[k] - a.max[k]});
    sum += d * d;
  }
  return sum;
}

double distance_bound(const std::array<Vec3, 3>& t, const Box3& box) {
  const Vec3 centre = (box.min + box.max) / 2, half = box.extent() / 2;
  double bound = 0;
  const auto along = [&](Vec3 axis) {
    const double norm = length(axis);
    if (!(norm > 0)) return;
    const double middle = dot(centre, axis);
    const double reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    const double a = dot(t[0], axis), b = dot(t[1], axis), c = dot(t[2], axis);
    bound = std::max({bound, (std::min({a, b, c}) - middle - reach) / norm,
                      (middle - reach - std::max({a, b, c})) / norm});
  };
  along({1, 0, 0});
  along({0, 1, 0});
  along({0, 0, 1});
  along(cross(t[1] - t[0], t[2] - t[0]));
  Vec3 edge = t[1] - t[0], from = t[0];
  for (int e = 1; e < 3; ++e)
    if (const Vec3 other = t[(e + 1) % 3] - t[e]; dot(other, other) > dot(edge, edge)) {
      edge = other;
      from = t[e];
    }
  if (dot(edge, edge) > 0) along(centre - from - edge * (dot(centre - from, edge) / dot(edge, edge)));
  // What rounding may have added, in voxels of a grid whose coordinates have a few more digits.
  return std::max(0.0, bound - 1e-6);
}

}  // namespace mesocell
