#pragma once

#include <cstdint>
#include <optional>

#include "format/api.h"
#include "sdk/core/rng.h"
#include "sdk/shade/environment.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

/// What the object is made of, and how it is lit.
struct Lighting {
  /// Mirror reflections that are followed; 0 is a matt object. [Nürnberg 2011, 3.2.3]
  std::uint32_t bounces = 0;
  /// Share of a mirror's light that is reflected; the rest is matt. In [0, 1].
  double reflectivity = 1;
  /// Index of refraction of a clear object, at least 1; 0 is an opaque one. [Nürnberg 2011, 3.2.4]
  double ior = 0;
  /// Refractions and total reflections that are followed in a clear object.
  std::uint32_t events = 6;
  /// Direction towards a distant light that casts hard shadows; without one the light is soft and from the
  /// viewer's upper left.
  std::optional<Vec3> light = std::nullopt;
  /// Rays of ambient occlusion a hit; 0 for none. They reach a tenth of the object's diagonal.
  std::uint32_t occlusion_rays = 0;
};

/// Light that comes back along a ray. Closed-form where the scene is: a mirror or clear object in an even
/// environment returns just that.
class Radiance {
 public:
  /// `view`: the camera's direction, for light that comes from the viewer. All is kept by reference.
  Radiance(const Caster& caster, const Lighting& lighting, const Environment& environment, Vec3 view);

  /// Of a ray that hit the object as `hit` says; the ray's direction has length 1.
  [[nodiscard]] Vec3 of_hit(const Ray& ray, const Hit& hit, Rng& rng) const;

 private:
  [[nodiscard]] Vec3 matt(const Ray& ray, const Hit& hit, Rng& rng) const;
  [[nodiscard]] Vec3 mirror(Ray ray, Hit hit, Rng& rng) const;
  [[nodiscard]] Vec3 glass(Ray ray, Hit hit) const;
  [[nodiscard]] double open_sky(Vec3 point, Vec3 normal, Rng& rng) const;
  /// The shading normal, turned to the side that the ray comes from.
  [[nodiscard]] Vec3 facing_normal(const Ray& ray, const Hit& hit) const;
  /// A start for a ray from a hit that is outside the object; false if none is found near.
  [[nodiscard]] bool leave(const Hit& hit, Vec3 point, Vec3 normal, Vec3& start) const;

  const Caster& caster_;
  const Lighting& lighting_;
  const Environment& environment_;
  Vec3 view_;
  double reach_;  ///< of ambient occlusion, metres
};

/// Direction of a mirrored ray; `normal` has length 1.
[[nodiscard]] Vec3 reflect(Vec3 direction, Vec3 normal);

/// Direction of a refracted ray by Snell's law; empty where all is reflected. `ratio`: index before over
/// index behind; `normal` has length 1 and is against the direction, which has length 1 too.
[[nodiscard]] std::optional<Vec3> refract(Vec3 direction, Vec3 normal, double ratio);

}  // namespace mesocell
