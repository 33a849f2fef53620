#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sdk/trace/cell_scene.h"

namespace mesocell {

/// What the methods that sample a cell object at points have in common.
class SamplingCaster : public Caster {
 public:
  explicit SamplingCaster(const CellObject& object) : scene_(object) {}

  bool first_hit(const Ray& ray, Hit& hit) const final {
    std::uint64_t samples = 0;
    return search(ray, hit, samples);
  }

  std::uint64_t count_steps(std::span<const Ray> rays) const final {
    std::uint64_t samples = 0;
    Hit hit;
    for (const Ray& ray : rays) search(ray, hit, samples);
    return samples;
  }

  bool inside(Vec3 point) const final { return scene_.inside_point(point); }
  Vec3 color(const Hit& hit, Vec3 point) const final { return scene_.color(hit, point); }
  double detail() const final { return scene_.voxel_edge(); }
  Vec3 shading_normal(const Hit& hit) const final { return scene_.shading_normal(hit); }
  Box3 object_box() const final { return scene_.object_box(); }
  std::uint64_t memory_bytes() const final { return scene_.memory_bytes(); }

 protected:
  /// first_hit(), which adds the samples it takes to `samples`.
  virtual bool search(const Ray& ray, Hit& hit, std::uint64_t& samples) const = 0;

  /// Where a ray leaves a box, and by which axis.
  struct Exit {
    double t = std::numeric_limits<double>::infinity();
    int axis = -1;
  };
  static Exit leave(const WalkRay& ray, const Voxel& low, const Voxel& high) {
    Exit exit;
    for (std::size_t a = 0; a < 3; ++a) {
      if (ray.direction[a] == 0) continue;
      const double t = passage_t(ray, {a, ray.rises(a) ? high[a] : low[a]});
      if (t < exit.t) exit = {t, int(a)};
    }
    return exit;
  }

  static Voxel voxel_at_t(const WalkRay& ray, double t) {
    Voxel v{};
    for (std::size_t a = 0; a < 3; ++a) v[a] = std::int64_t(std::floor(ray.origin[a] + t * ray.direction[a]));
    return v;
  }

  /// t for a way of one voxel.
  static double per_voxel(const WalkRay& ray) {
    return 1 / length({ray.direction[0], ray.direction[1], ray.direction[2]});
  }

  [[nodiscard]] bool is_inside(const Voxel& v) const { return scene_.in_grid(v) && scene_.inside(v); }

  /// Tells a hit on a voxel that a sample at `t` is in. A sample just beyond a corner, by rounding, may be in
  /// a voxel that the ray does not visit; the face is then one that is near.
  void tell_hit(const WalkRay& ray, const Voxel& v, double t, Hit& hit) const {
    scene_.set_hit(ray, {v, t, entry_axis(ray, v)}, hit);
  }

  /// Tells that a ray leaves the object by way of voxel `v`, the last inside.
  void tell_exit(const WalkRay& ray, const Voxel& v, double t, Hit& hit) const {
    scene_.set_hit(ray, {v, t, leave(ray, v, {v[0] + 1, v[1] + 1, v[2] + 1}).axis}, hit);
    hit.face_normal = -hit.face_normal;
  }

  CellScene scene_;
};

}  // namespace mesocell
