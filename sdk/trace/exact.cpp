#include "sdk/trace/exact.h"

#include "sdk/trace/cell_scene.h"
#include "sdk/trace/walk.h"

namespace mesocell {
namespace {

class ExactCaster final : public Caster {
 public:
  explicit ExactCaster(const CellObject& object) : scene_(object) {}

  bool first_hit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    Voxel low{}, high{};
    while (scene_.empty_box(place.voxel, low, high)) {
      leave_box(walk, low, high, place);
      if (!scene_.in_grid(place.voxel)) return false;
    }
    place.entry_axis = entry_axis(walk, place.voxel);
    scene_.set_hit(walk, place, hit);
    return true;
  }

  bool first_exit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    if (place.entry_axis >= 0 || !scene_.inside(place.voxel)) return false;
    Voxel low{}, high{}, last{};
    do {
      // The last voxel inside is told by the face that the ray leaves by.
      scene_.solid_box(place.voxel, low, high);
      last = leave_box(walk, low, high, place);
    } while (scene_.in_grid(place.voxel) && scene_.inside(place.voxel));
    WalkPlace exit = place;
    exit.voxel = last;
    scene_.set_hit(walk, exit, hit);
    hit.face_normal = -hit.face_normal;
    return true;
  }

  bool inside(Vec3 point) const override { return scene_.inside_point(point); }
  Vec3 shading_normal(const Hit& hit) const override { return scene_.shading_normal(hit); }
  Vec3 color(const Hit& hit, Vec3 point) const override { return scene_.color(hit, point); }
  double detail() const override { return scene_.voxel_edge(); }
  Box3 object_box() const override { return scene_.object_box(); }
  std::uint64_t memory_bytes() const override { return scene_.memory_bytes(); }

 private:
  CellScene scene_;
};

}  // namespace

std::unique_ptr<Caster> make_exact_caster(const CellObject& object) {
  return std::make_unique<ExactCaster>(object);
}

}  // namespace mesocell
