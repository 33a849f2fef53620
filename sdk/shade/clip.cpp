#include "sdk/shade/clip.h"

#include <cmath>
#include <limits>

namespace mesocell {

ClippedCaster::ClippedCaster(const Caster& caster, Vec3 normal, double distance)
    : caster_(caster), normal_(normalize(normal)), distance_(distance / length(normal)) {}

bool ClippedCaster::kept(const Ray& ray, double& begin, double& end) const {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const double height = dot(normal_, ray.origin) - distance_, slope = dot(normal_, ray.direction);
  begin = 0;
  end = inf;
  if (slope == 0) return height <= 0;
  const double t = -height / slope;
  (slope < 0 ? begin : end) = slope < 0 ? std::max(t, 0.0) : t;
  return end > 0;
}

bool ClippedCaster::first_hit(const Ray& ray, Hit& hit) const {
  double begin, end;
  if (!kept(ray, begin, end)) return false;
  const Ray rest{ray.origin + ray.direction * begin, ray.direction};
  if (!caster_.first_hit(rest, hit)) return false;
  // A ray that enters the kept side within the object hits the cut.
  if (hit.t == 0 && begin > 0) {
    hit.face_normal = normal_;
    hit.on_cut = true;
  }
  hit.t += begin;
  return hit.t < end;
}

bool ClippedCaster::first_exit(const Ray& ray, Hit& hit) const {
  double begin, end;
  if (!inside(ray.origin) || !kept(ray, begin, end) || !caster_.first_exit(ray, hit)) return false;
  if (hit.t <= end) return true;
  // It leaves through the cut. Which part it leaves is what a ray back from there would hit.
  Hit cut;
  if (caster_.first_hit({ray.origin + ray.direction * end, ray.direction}, cut)) {
    hit.element = cut.element;
    hit.label = cut.label;
    hit.instance = cut.instance;
  }
  hit.t = end;
  hit.face_normal = normal_;
  hit.on_cut = true;
  return true;
}

bool ClippedCaster::inside(Vec3 point) const {
  return dot(normal_, point) <= distance_ && caster_.inside(point);
}

Vec3 ClippedCaster::shading_normal(const Hit& hit) const {
  return hit.on_cut ? normal_ : caster_.shading_normal(hit);
}

}  // namespace mesocell
