#pragma once

#include <array>
#include <cstdint>

#include "sdk/core/ray.h"
#include "sdk/core/vec.h"

namespace mesocell {

/// Where a ray meets an object.
struct Hit {
  double t = 0;               ///< ray parameter; metres if the ray's direction has length 1
  std::uint32_t label = 0;    ///< what was hit: of a cell object the cell, from 1
  std::int64_t instance = 0;  ///< which copy of it: of a cell object the index of the home tile
  std::uint32_t placement = 0;  ///< which asset of a scene
  std::array<std::int64_t, 3>
      element{};        ///< the smallest part that was hit: of a cell object the grid's voxel
  Vec3 face_normal;     ///< unit normal of the face entered; zero if the ray began inside
  bool on_cut = false;  ///< on a plane that the object is cut by, whose normal face_normal then is
};

/// One representation, prepared for one method of tracing. Thread safety: all calls are const and reentrant.
class Caster {
 public:
  virtual ~Caster() = default;

  /// The nearest hit. False for a miss, and for a ray that is not finite or has no direction. No allocation.
  [[nodiscard]] virtual bool first_hit(const Ray& ray, Hit& hit) const = 0;

  /// Where a ray that begins inside the object leaves it: `t` of the exit, the last part inside as `element`,
  /// and the outward normal of the face it leaves by. False if the ray does not begin inside. No allocation.
  [[nodiscard]] virtual bool first_exit(const Ray& ray, Hit& hit) const = 0;

  /// Whether a point is inside the object. Points beyond its box are not.
  [[nodiscard]] virtual bool inside(Vec3 point) const = 0;

  /// Unit normal to shade a hit of first_hit() or first_exit() with, outward.
  [[nodiscard]] virtual Vec3 shading_normal(const Hit& hit) const = 0;

  /// Color of the object at a point, as the hit's part has it; linear light, each channel in [0, 1].
  [[nodiscard]] virtual Vec3 color(const Hit& hit, Vec3 point) const = 0;

  /// Size of the smallest detail, metres: of a cell object the edge of a voxel.
  [[nodiscard]] virtual double detail() const = 0;

  /// What the object's tiles cover, metres.
  [[nodiscard]] virtual Box3 object_box() const = 0;
};

}  // namespace mesocell
