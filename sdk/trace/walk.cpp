#include "sdk/trace/walk.h"

#include <algorithm>
#include <cmath>

namespace mesocell {
namespace {

constexpr double kNegligible = 0x1p-128;
constexpr double kMaxOrigin = 0x1p46;

/// A sum of doubles without rounding: components that do not overlap, ascending in magnitude [Shewchuk 1997].
class Expansion {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      // Two-sum: sum + error equals the two numbers exactly.
      const double sum = x + terms_[k], part = sum - x;
      const double error = (x - (sum - part)) + (terms_[k] - part);
      if (error != 0) terms_[kept++] = error;
      x = sum;
    }
    if (x != 0) terms_[kept++] = x;
    count_ = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  /// Adds (integer - x) · factor.
  void add_difference_times(double integer, double x, double factor) {
    const double difference = integer - x, part = difference - integer;
    const double error = (integer - (difference - part)) + (-x - part);
    add_product(error, factor);
    add_product(difference, factor);
  }
  [[nodiscard]] int sign() const { return count_ == 0 ? 0 : terms_[count_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 16> terms_{};
  std::size_t count_ = 0;
};

}  // namespace

bool WalkRay::make(const Ray& ray, WalkRay& out) {
  if (!is_finite(ray.origin) || !is_finite(ray.direction)) return false;
  const double largest =
      std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
  if (largest == 0) return false;
  const int exponent = std::ilogb(largest);
  out.octant = 0;
  out.scale = std::ldexp(1.0, -exponent);
  for (std::size_t a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = std::ldexp(ray.direction[a], -exponent);
    if (std::abs(o) > kMaxOrigin) return false;
    out.origin[a] = std::abs(o) < kNegligible ? 0 : o;
    out.direction[a] = std::abs(d) < kNegligible ? 0 : d;
    out.inverse[a] = out.direction[a] == 0 ? 0 : 1 / out.direction[a];
    out.octant |= unsigned{out.rises(a)} << a;
  }
  return true;
}

bool detail::comes_before_exactly(const WalkRay& ray, const Passage& p, const Passage& q) {
  // The sign of t_p - t_q = (plane_p - o_p) / d_p - (plane_q - o_q) / d_q, multiplied by both directions.
  const double dp = ray.direction[p.axis], dq = ray.direction[q.axis];
  Expansion e;
  e.add_difference_times(double(p.plane), ray.origin[p.axis], dq);
  e.add_difference_times(double(q.plane), ray.origin[q.axis], -dp);
  const int sign = (dp > 0) == (dq > 0) ? e.sign() : -e.sign();
  return sign < 0 || (sign == 0 && dp > 0 && dq < 0);
}

std::int64_t detail::coordinate_exactly(const WalkRay& ray, const Passage& p, std::size_t axis,
                                        std::int64_t nearest) {
  // The sign of o + t·d - nearest with t = (plane - o_p) / d_p, multiplied by d_p.
  const double dp = ray.direction[p.axis], d = ray.direction[axis];
  Expansion e;
  e.add_difference_times(double(p.plane), ray.origin[p.axis], d);
  e.add_difference_times(double(nearest), ray.origin[axis], -dp);
  const int sign = dp > 0 ? e.sign() : -e.sign();
  if (sign != 0) return sign > 0 ? nearest : nearest - 1;
  // On the plane. At a rising passage this is the point itself; right after a falling one, an axis that falls
  // too has left the plane.
  return dp < 0 && d < 0 ? nearest - 1 : nearest;
}

bool enter_grid(const WalkRay& ray, const Voxel& size, WalkPlace& place) {
  place = {};
  Passage last;
  double last_t = 0;
  bool outside = false;
  for (std::size_t a = 0; a < 3; ++a) {
    place.voxel[a] = std::int64_t(std::floor(ray.origin[a]));
    const bool below = place.voxel[a] < 0, above = place.voxel[a] >= size[a];
    if (!below && !above) continue;
    if (ray.direction[a] == 0 || ray.rises(a) != below) return false;
    const Passage p{a, below ? 0 : size[a]};
    const double t = passage_t(ray, p);
    if (!outside || comes_before(ray, last, last_t, p, t)) {
      last = p;
      last_t = t;
    }
    outside = true;
  }
  if (!outside) return true;
  place.voxel = voxel_at(ray, last, last_t);
  place.t = last_t;
  place.entry_axis = int(last.axis);
  for (std::size_t a = 0; a < 3; ++a)
    if (place.voxel[a] < 0 || place.voxel[a] >= size[a]) return false;
  return true;
}

int entry_axis(const WalkRay& ray, const Voxel& v) {
  bool begins = true;
  int axis = -1;
  Passage last;
  double last_t = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    begins = begins && double(v[a]) == std::floor(ray.origin[a]);
    if (ray.direction[a] == 0) continue;
    const Passage p{a, v[a] + (ray.rises(a) ? 0 : 1)};
    const double t = passage_t(ray, p);
    if (axis >= 0 && !comes_before(ray, last, last_t, p, t)) continue;
    axis = int(a);
    last = p;
    last_t = t;
  }
  return begins ? -1 : axis;
}

Voxel voxel_before(const WalkRay& ray, const WalkPlace& place) {
  const auto passage_into = [&](std::size_t a) {
    return Passage{a, place.voxel[a] + (ray.rises(a) ? 0 : 1)};
  };
  const std::size_t axis = std::size_t(place.entry_axis);
  const Passage p = passage_into(axis);
  const double t = passage_t(ray, p);
  Voxel before = place.voxel;
  for (std::size_t a = 0; a < 3; ++a) {
    // Planes that are met at the same point are passed together if the ray rises on both axes, or falls on
    // both.
    if (a != axis) {
      if (ray.direction[a] == 0 || ray.rises(a) != ray.rises(axis)) continue;
      const Passage q = passage_into(a);
      const double q_t = passage_t(ray, q);
      if (comes_before(ray, p, t, q, q_t) || comes_before(ray, q, q_t, p, t)) continue;
    }
    before[a] -= ray.rises(a) ? 1 : -1;
  }
  return before;
}

}  // namespace mesocell
