#include "sdk/trace/linear.h"

#include <algorithm>
#include <cmath>

#include "sdk/trace/sampling_caster.h"

namespace mesocell {
namespace {

constexpr double kBisectionVoxels = 1.0 / 64;

class LinearCaster final : public SamplingCaster {
 public:
  LinearCaster(const CellObject& object, double step, LinearStep rule)
      : SamplingCaster(object), step_voxels_(step * scene_.tile_edge()), rule_(rule) {}

  bool first_exit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    if (!WalkRay::make(scene_.to_voxels(ray), walk)) return false;
    const double step = step_voxels_ * per_voxel(walk);
    if (!is_inside(voxel_at_t(walk, 0))) return false;
    double before = 0, t = step;
    for (double n = 1; is_inside(voxel_at_t(walk, t)); t = ++n * step) before = t;
    while (t - before > kBisectionVoxels * per_voxel(walk)) {
      const double middle = before + (t - before) / 2;
      (is_inside(voxel_at_t(walk, middle)) ? before : t) = middle;
    }
    tell_exit(walk, voxel_at_t(walk, before), t, hit);
    return true;
  }

 private:
  bool search(const Ray& ray, Hit& hit, std::uint64_t& samples) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    const double voxel = per_voxel(walk), end = leave(walk, {0, 0, 0}, scene_.size()).t;
    double start = place.t, step = step_after(walk, place.entry_axis);

    double before = start, t = start;
    // Samples lie at start + n·step, with a fixed step also after a skip.
    for (double n = 0;; t = start + n * step) {
      place.voxel = voxel_at_t(walk, t);
      ++samples;
      if (!scene_.in_grid(place.voxel)) {
        // Rounding can put a sample near the border beyond it; only past the exit is the ray done.
        if (t > end) return false;
        n += 1;
        before = t;
        continue;
      }
      Voxel low{}, high{};
      if (scene_.empty_tiles(place.voxel, walk.octant, low, high)) {
        const Exit exit = leave(walk, low, high);
        const double next = std::min(exit.t, end + step);
        before = t;
        if (rule_ == LinearStep::kByAngle && next > t) {
          start = next;
          step = step_after(walk, exit.axis);
          n = 0;
        } else {
          n = std::max(n + 1, std::ceil((next - start) / step));
        }
        continue;
      }
      if (scene_.inside(place.voxel)) break;
      before = t;
      n += 1;
    }
    while (t - before > kBisectionVoxels * voxel) {
      const double middle = before + (t - before) / 2;
      const Voxel v = voxel_at_t(walk, middle);
      ++samples;
      if (!is_inside(v)) {
        before = middle;
        continue;
      }
      t = middle;
      place.voxel = v;
    }
    tell_hit(walk, place.voxel, t, hit);
    return true;
  }

  /// The step behind a face across an axis, -1 for none, as a difference of t.
  [[nodiscard]] double step_after(const WalkRay& ray, int axis) const {
    const double voxel = per_voxel(ray), step = step_voxels_ * voxel;
    if (rule_ == LinearStep::kFixed || axis < 0) return step;
    return step * std::max(kLeastCosine, std::abs(ray.direction[std::size_t(axis)]) * voxel);
  }

  double step_voxels_;
  LinearStep rule_;
};

}  // namespace

std::unique_ptr<Caster> make_linear_caster(const CellObject& object, double step, LinearStep rule) {
  return std::make_unique<LinearCaster>(object, step, rule);
}

}  // namespace mesocell
