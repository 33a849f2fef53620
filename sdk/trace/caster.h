#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "format/api.h"
#include "sdk/core/ray.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// Where a ray meets an object.
struct Hit {
  double t = 0;                 ///< ray parameter; metres if the ray's direction has length 1
  std::uint32_t label = 0;      ///< what was hit: of a cell object the cell, from 1
  std::int64_t instance = 0;    ///< which copy of it: of a cell object the index of the home tile
  std::uint32_t placement = 0;  ///< which asset of a scene
  std::uint8_t level = 0;       ///< of detail: elements of a cell object are of 2^level voxels a side
  std::array<std::int64_t, 3>
      element{};        ///< the smallest part that was hit: of a cell object the grid's voxel
  Vec3 face_normal;     ///< unit normal of the face entered; zero if the ray began inside
  bool on_cut = false;  ///< on a plane that the object is cut by, whose normal face_normal then is
};

/// Where a ray of a stream meets an object: what costs least to tell. Caster::details() tells the rest.
struct StreamHit {
  static constexpr double kMiss = std::numeric_limits<double>::infinity();

  double t = kMiss;                       ///< as Hit's; kMiss if nothing is hit
  std::array<std::int32_t, 3> element{};  ///< as Hit's
  std::uint32_t label = 0;                ///< as Hit's; 0 for a miss
  /// By which face of the element the ray came: 2 · axis + 1 if its normal points up the axis, else 2 · axis;
  /// kBegan if the ray began inside, kOther where a normal along no axis is meant.
  std::int8_t face = kBegan;
  static constexpr std::int8_t kBegan = -1, kOther = -2;
  std::uint8_t level = 0;  ///< as Hit's

  [[nodiscard]] bool hit() const { return t < kMiss; }
};

[[nodiscard]] StreamHit to_stream_hit(const Hit& hit);

/// One representation, prepared for one method of tracing. Thread safety: all calls are const and reentrant.
class Caster {
 public:
  virtual ~Caster() = default;

  /// The nearest hit. False for a miss, and for a ray that is not finite or has no direction. No allocation.
  [[nodiscard]] virtual bool first_hit(const Ray& ray, Hit& hit) const = 0;

  /// The nearest hits of many rays, hits[k] of rays[k]: what first_hit() finds, faster. Rays that begin near
  /// each other and go the same way should be near each other in the stream too: squares of 8 × 8 pixels,
  /// rows in turn, are best. `hits` has as many entries as `rays` (assert). No allocation.
  virtual void first_hits(std::span<const Ray> rays, std::span<StreamHit> hits) const;

  /// What first_hit() tells of a ray, from what first_hits() told of it, which is no miss.
  [[nodiscard]] virtual Hit details(const Ray& ray, const StreamHit& hit) const;

  /// Whether anything is hit at t ≤ `end`. False also for a ray that is not finite or has no direction, and
  /// for an end that is no number. No allocation.
  [[nodiscard]] virtual bool any_hit(const Ray& ray, double end) const;

  /// The same of many rays: found[k] is 1 or 0, of rays[k] up to ends[k]. All spans have one length (assert).
  virtual void any_hits(std::span<const Ray> rays, std::span<const double> ends,
                        std::span<std::uint8_t> found) const;

  /// All stretches of the ray that are inside the object, in order. `visit` is given where each begins, as
  /// first_hit() tells it, and where it ends, as first_exit() does, with t from the ray's origin; it returns
  /// false to stop. What touches is one stretch. That of a ray that begins inside begins at t = 0, by no
  /// face. None of a ray that is not finite or has no direction. No allocation.
  ///
  /// Made of first_hit() and first_exit() of rays that begin a little behind where the last one ended, unless
  /// the method says otherwise: stretches and gaps shorter than 1/1024 of detail() can be missed, of rays
  /// from far away those shorter than 2^-48 of the way.
  virtual void all_hits(const Ray& ray,
                        const std::function<bool(const Hit& in, const Hit& out)>& visit) const;

  /// How many steps first_hits() takes for these rays: places at which maps are looked up. 0 if it is not
  /// counted.
  [[nodiscard]] virtual std::uint64_t count_steps(std::span<const Ray> rays) const;

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

  /// What the prepared object takes, bytes: maps, tables and all.
  [[nodiscard]] virtual std::uint64_t memory_bytes() const = 0;
};

}  // namespace mesocell
