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
    scene_.set_hit(walk, place, hit);
    return true;
  }

  Vec3 shading_normal(const Hit& hit) const override { return scene_.shading_normal(hit); }
  Box3 object_box() const override { return scene_.object_box(); }

 private:
  CellScene scene_;
};

}  // namespace

std::unique_ptr<Caster> make_exact_caster(const CellObject& object) {
  return std::make_unique<ExactCaster>(object);
}

}  // namespace mesocell
