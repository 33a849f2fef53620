#include "sdk/membership/crossing.h"

#include <cstddef>

#include "sdk/membership/predicates.h"

namespace mesocell {

std::int32_t crossing(const std::array<Vec3, 3>& v, Vec3 p) {
  // The ε³ in z puts a vertex at the point's height below it. Then either no edge spans it or two do.
  int count = 0;
  bool beyond[2], upward[2];
  for (std::size_t e = 0; e < 3; ++e) {
    const Vec3 &a = v[e], &b = v[(e + 1) % 3];
    if ((a.z > p.z) == (b.z > p.z)) continue;
    upward[count] = a.z < b.z;
    const Vec3 &low = upward[count] ? a : b, &high = upward[count] ? b : a;
    // A point on the edge counts as beyond it: the ε² in y moves it there, whatever the ε³ in z does.
    beyond[count] = orientation_2d(low.y, low.z, high.y, high.z, p.y, p.z) <= 0;
    ++count;
  }
  if (count != 2 || beyond[0] == beyond[1]) return 0;
  // Seen along -x with y to the right, a counter-clockwise triangle runs down on its left.
  const std::int32_t delta = upward[beyond[0] ? 0 : 1] ? 1 : -1;
  // On the plane counts as beyond it: the ε in x moves it there.
  return delta * orientation_3d(v[0], v[1], v[2], p) <= 0 ? delta : 0;
}

}  // namespace mesocell
