#include "sdk/trace/distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdk/trace/sampling_caster.h"

namespace mesocell {
namespace {

/// A ray in single precision from where it enters the grid: a step of t is the same number of voxels along
/// the axis that it goes along most.
struct FloatRay {
  std::array<float, 3> origin{}, direction{};

  FloatRay(const WalkRay& ray, double t) {
    double largest = 0;
    for (const double d : ray.direction) largest = std::max(largest, std::abs(d));
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = float(ray.origin[a] + t * ray.direction[a]);
      direction[a] = float(ray.direction[a] / largest);
    }
  }
  [[nodiscard]] std::array<float, 3> at(float t) const {
    std::array<float, 3> p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = origin[a] + t * direction[a];
    return p;
  }
};

Voxel voxel_of(const std::array<float, 3>& p) {
  Voxel v{};
  for (std::size_t a = 0; a < 3; ++a) v[a] = std::int64_t(std::floor(p[a]));
  return v;
}

/// The next t: as far as no axis leaves the box [low, high) on the side that the ray goes to, at least the
/// threshold.
float step_on(const FloatRay& ray, const Voxel& low, const Voxel& high, float t) {
  const std::array<float, 3> p = ray.at(t);
  float distance = HUGE_VALF;
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) continue;
    distance = std::min(distance, ray.direction[a] > 0 ? float(high[a]) - p[a] : p[a] - float(low[a]));
  }
  const float next = t + std::max(distance, kDistanceThreshold);
  // Far along, the threshold may be less than what rounding leaves of it.
  return next > t ? next : std::nextafter(t, HUGE_VALF);
}

class DistanceCaster final : public SamplingCaster {
 public:
  explicit DistanceCaster(const CellObject& object) : SamplingCaster(object) {}

  bool first_exit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !is_inside(voxel_at_t(walk, 0))) return false;
    const FloatRay from(walk, 0);
    float t = 0;
    Voxel last = voxel_at_t(walk, 0), v = last, low{}, high{};
    do {
      last = v;
      scene_.solid_box(v, walk.octant, low, high);
      t = step_on(from, low, high, t);
      v = voxel_of(from.at(t));
    } while (is_inside(v));
    tell_exit(walk, last, double(t) * per_step(walk), hit);
    return true;
  }

 private:
  bool search(const Ray& ray, Hit& hit, std::uint64_t& samples) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    const double end = (leave(walk, {0, 0, 0}, scene_.size()).t - place.t) / per_step(walk);
    const FloatRay from(walk, place.t);
    Voxel low{}, high{};
    for (float t = 0;; t = step_on(from, low, high, t)) {
      const Voxel v = voxel_of(from.at(t));
      ++samples;
      if (!scene_.in_grid(v)) {
        // Rounding can put a point near the border beyond it; only past the exit is the ray done.
        if (double(t) > end) return false;
        low = high = v;
        continue;
      }
      if (scene_.empty_box(v, walk.octant, low, high)) continue;
      tell_hit(walk, v, place.t + double(t) * per_step(walk), hit);
      return true;
    }
  }

  /// WalkRay's t for a step of 1.
  static double per_step(const WalkRay& ray) {
    double largest = 0;
    for (const double d : ray.direction) largest = std::max(largest, std::abs(d));
    return 1 / largest;
  }
};

}  // namespace

std::unique_ptr<Caster> make_distance_caster(const CellObject& object) {
  return std::make_unique<DistanceCaster>(object);
}

}  // namespace mesocell
