#pragma once

#include "format/api.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

/// An object cut by a plane: what is left of it satisfies normal · x ≤ distance. The cut shows the inside;
/// its normal is the plane's. `caster` is kept by reference.
class ClippedCaster final : public Caster {
 public:
  /// `normal` is not zero and need not have length 1; `distance` is measured in its length.
  ClippedCaster(const Caster& caster, Vec3 normal, double distance);

  [[nodiscard]] bool first_hit(const Ray& ray, Hit& hit) const override;
  [[nodiscard]] bool first_exit(const Ray& ray, Hit& hit) const override;
  [[nodiscard]] bool inside(Vec3 point) const override;
  [[nodiscard]] Vec3 shading_normal(const Hit& hit) const override;
  [[nodiscard]] Vec3 color(const Hit& hit, Vec3 point) const override { return caster_.color(hit, point); }
  [[nodiscard]] double detail() const override { return caster_.detail(); }
  [[nodiscard]] Box3 object_box() const override { return caster_.object_box(); }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return caster_.memory_bytes(); }

 private:
  /// The part of the ray on the kept side, t in [begin, end); false if there is none.
  bool kept(const Ray& ray, double& begin, double& end) const;

  const Caster& caster_;
  Vec3 normal_;
  double distance_;
};

}  // namespace mesocell
