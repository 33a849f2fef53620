#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "sdk/core/ray.h"

/// Exact steps of a ray through a grid of unit voxels. [spec 4.9]
///
/// A ray visits voxel v if some t ≥ 0 has origin + t·direction in [v, v + 1) on every axis. Where the ray
/// meets a plane between voxels is a quotient of doubles; which of two planes it meets first is decided from
/// rounded quotients where their error bounds allow, and exactly where they do not. So no voxel is missed and
/// none is visited that the ray does not touch, through edges and corners too.
namespace mesocell {

using Voxel = std::array<std::int64_t, 3>;

/// A ray in voxel units, made fit for exact steps: the greatest component of the direction is in [1, 2), and
/// what is smaller than 2^-128 in origin or direction is taken as 0, so that no product underflows.
struct WalkRay {
  std::array<double, 3> origin{}, direction{};
  std::array<double, 3> inverse{};  ///< 1 / direction, 0 where the direction is
  double scale = 1;                 ///< t of the ray that was given = scale · t of this one
  unsigned octant = 0;              ///< bit a is set if the ray rises on axis a

  /// False if a number is not finite, the origin is beyond 2^46 voxels, or all of the direction is 0.
  [[nodiscard]] static bool make(const Ray& ray, WalkRay& out);

  [[nodiscard]] bool rises(std::size_t axis) const { return direction[axis] > 0; }
};

/// The ray's passage through the plane x[axis] = plane. At it, a ray that rises on the axis is already in the
/// voxel above (its t is the first there); one that falls is still above and enters the voxel below right
/// after.
struct Passage {
  std::size_t axis = 0;
  std::int64_t plane = 0;
};

/// t of a passage, with a relative error below 2^-51. The direction is not 0 on the axis.
[[nodiscard]] inline double passage_t(const WalkRay& ray, const Passage& p) {
  return (double(p.plane) - ray.origin[p.axis]) * ray.inverse[p.axis];
}

namespace detail {
[[nodiscard]] bool comes_before_exactly(const WalkRay& ray, const Passage& p, const Passage& q);
[[nodiscard]] std::int64_t coordinate_exactly(const WalkRay& ray, const Passage& p, std::size_t axis,
                                              std::int64_t nearest);
inline constexpr double kRelativeError = 0x1p-50;
inline constexpr double kFar = 0x1p45;
}  // namespace detail

/// Whether `p` comes before `q`, a passage of another axis: by t, and at equal t rising axes before falling
/// ones. Exact; the direction is 0 on neither axis.
[[nodiscard]] inline bool comes_before(const WalkRay& ray, const Passage& p, double p_t, const Passage& q,
                                       double q_t) {
  if (std::abs(p_t - q_t) > detail::kRelativeError * (std::abs(p_t) + std::abs(q_t))) return p_t < q_t;
  return detail::comes_before_exactly(ray, p, q);
}

/// The voxel coordinate on `axis`, another than the passage's, at the passage. Exact where it is below 2^45
/// in magnitude, else only known to be beyond any grid.
[[nodiscard]] inline std::int64_t coordinate_at(const WalkRay& ray, const Passage& p, double p_t,
                                                std::size_t axis) {
  const double move = p_t * ray.direction[axis], x = ray.origin[axis] + move;
  if (!(std::abs(x) < detail::kFar)) return std::int64_t(std::copysign(detail::kFar, x));
  const double nearest = std::nearbyint(x);
  const double error = detail::kRelativeError * (std::abs(ray.origin[axis]) + std::abs(move));
  if (std::abs(x - nearest) > error) return std::int64_t(std::floor(x));
  return detail::coordinate_exactly(ray, p, axis, std::int64_t(nearest));
}

/// The voxel at passage `p`: on its axis the one that is entered.
[[nodiscard]] inline Voxel voxel_at(const WalkRay& ray, const Passage& p, double p_t) {
  Voxel v{};
  for (std::size_t a = 0; a < 3; ++a)
    v[a] = a == p.axis ? p.plane - (ray.rises(a) ? 0 : 1) : coordinate_at(ray, p, p_t, a);
  return v;
}

/// A place in a walk: a voxel that the ray visits, and how it was entered.
struct WalkPlace {
  Voxel voxel{};
  double t = 0;         ///< of the entry, in WalkRay's units; 0 if the ray begins here
  int entry_axis = -1;  ///< -1 if the ray begins here
};

/// The first voxel of the grid [0, size) that the ray visits. False if there is none.
[[nodiscard]] bool enter_grid(const WalkRay& ray, const Voxel& size, WalkPlace& place);

/// The axis of the face by which a ray enters voxel `v`, which it visits. [spec 4.9, Face] Of the passages
/// through those planes of the voxel that face the ray it is the last one's, of several that come at once the
/// least. It so depends on ray and voxel alone, not on the boxes that a walk came through. -1 if the ray
/// begins in the voxel.
[[nodiscard]] int entry_axis(const WalkRay& ray, const Voxel& v);

/// The last voxel that the ray visits before it enters that of `place`, which is not its first.
[[nodiscard]] Voxel voxel_before(const WalkRay& ray, const WalkPlace& place);

/// Moves on to the first voxel visited outside the box [low, high) of voxels, which holds the present one.
inline void leave_box(const WalkRay& ray, const Voxel& low, const Voxel& high, WalkPlace& place) {
  Passage best;
  double best_t = 0;
  bool any = false;
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) continue;
    const Passage p{a, ray.rises(a) ? high[a] : low[a]};
    const double t = passage_t(ray, p);
    if (!any || comes_before(ray, p, t, best, best_t)) {
      best = p;
      best_t = t;
    }
    any = true;
  }
  place.voxel = voxel_at(ray, best, best_t);
  place.t = best_t;
  place.entry_axis = int(best.axis);
}

}  // namespace mesocell
