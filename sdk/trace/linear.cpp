#include "sdk/trace/linear.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdk/trace/cell_scene.h"
#include "sdk/trace/walk.h"

namespace mesocell {
namespace {

constexpr double kBisectionVoxels = 1.0 / 64;

class LinearCaster final : public Caster {
 public:
  LinearCaster(const CellObject& object, double step)
      : scene_(object), step_voxels_(step * scene_.tile_edge()) {}

  bool first_hit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    const double per_voxel =
        1 / length({walk.direction[0], walk.direction[1], walk.direction[2]});  // t for a way of one voxel
    const double step = step_voxels_ * per_voxel, entry = place.t;
    const double end = leave_t(walk, {0, 0, 0}, scene_.size());

    double before = entry, t = entry;
    // Samples lie at entry + n·step, also after a skip.
    for (double n = 0;; t = entry + n * step) {
      place.voxel = voxel_at_t(walk, t);
      if (!scene_.in_grid(place.voxel)) {
        // Rounding can put a sample near the border beyond it; only past the exit is the ray done.
        if (t > end) return false;
        n += 1;
        before = t;
        continue;
      }
      Voxel low{}, high{};
      if (scene_.empty_tiles(place.voxel, walk.octant, low, high)) {
        const double exit = std::min(leave_t(walk, low, high), end + step);
        before = t;
        n = std::max(n + 1, std::ceil((exit - entry) / step));
        continue;
      }
      if (scene_.inside(place.voxel)) break;
      before = t;
      n += 1;
    }
    while (t - before > kBisectionVoxels * per_voxel) {
      const double middle = before + (t - before) / 2;
      const Voxel v = voxel_at_t(walk, middle);
      if (!is_inside(v)) {
        before = middle;
        continue;
      }
      t = middle;
      place.voxel = v;
    }
    place.t = t;
    place.entry_axis = entry_axis(walk, place.voxel);
    scene_.set_hit(walk, place, hit);
    return true;
  }

  bool first_exit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    if (!WalkRay::make(scene_.to_voxels(ray), walk)) return false;
    const double per_voxel = 1 / length({walk.direction[0], walk.direction[1], walk.direction[2]});
    const double step = step_voxels_ * per_voxel;
    WalkPlace place;
    place.voxel = voxel_at_t(walk, 0);
    if (!is_inside(place.voxel)) return false;
    double before = 0, t = step;
    for (double n = 1; is_inside(voxel_at_t(walk, t)); t = ++n * step) before = t;
    while (t - before > kBisectionVoxels * per_voxel) {
      const double middle = before + (t - before) / 2;
      (is_inside(voxel_at_t(walk, middle)) ? before : t) = middle;
    }
    place.voxel = voxel_at_t(walk, before);
    place.t = t;
    place.entry_axis = exit_axis(walk, place.voxel);
    scene_.set_hit(walk, place, hit);
    hit.face_normal = -hit.face_normal;
    return true;
  }

  bool inside(Vec3 point) const override { return scene_.inside_point(point); }
  Vec3 color(const Hit& hit, Vec3 point) const override { return scene_.color(hit, point); }
  double detail() const override { return scene_.voxel_edge(); }
  Vec3 shading_normal(const Hit& hit) const override { return scene_.shading_normal(hit); }
  Box3 object_box() const override { return scene_.object_box(); }
  std::uint64_t memory_bytes() const override { return scene_.memory_bytes(); }

 private:
  static Voxel voxel_at_t(const WalkRay& ray, double t) {
    Voxel v{};
    for (std::size_t a = 0; a < 3; ++a) v[a] = std::int64_t(std::floor(ray.origin[a] + t * ray.direction[a]));
    return v;
  }

  /// t at which the ray leaves a box of voxels.
  static double leave_t(const WalkRay& ray, const Voxel& low, const Voxel& high) {
    double t = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < 3; ++a)
      if (ray.direction[a] != 0) t = std::min(t, passage_t(ray, {a, ray.rises(a) ? high[a] : low[a]}));
    return t;
  }

  /// The axis of the face by which the ray entered a voxel; -1 if it began in it.
  static int entry_axis(const WalkRay& ray, const Voxel& v) {
    int axis = -1;
    double last = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (ray.direction[a] == 0) continue;
      const double t = passage_t(ray, {a, v[a] + (ray.rises(a) ? 0 : 1)});
      if (t <= last) continue;
      last = t;
      axis = int(a);
    }
    return axis;
  }

  /// The axis of the face by which the ray leaves a voxel.
  static int exit_axis(const WalkRay& ray, const Voxel& v) {
    int axis = -1;
    double first = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < 3; ++a) {
      if (ray.direction[a] == 0) continue;
      const double t = passage_t(ray, {a, v[a] + (ray.rises(a) ? 1 : 0)});
      if (t >= first) continue;
      first = t;
      axis = int(a);
    }
    return axis;
  }

  [[nodiscard]] bool is_inside(const Voxel& v) const { return scene_.in_grid(v) && scene_.inside(v); }

  CellScene scene_;
  double step_voxels_;
};

}  // namespace

std::unique_ptr<Caster> make_linear_caster(const CellObject& object, double step) {
  return std::make_unique<LinearCaster>(object, step);
}

}  // namespace mesocell
