#include "sdk/shade/radiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mesocell {
namespace {

/// Starts of secondary rays are moved by this share of the smallest detail, to be on the right side of the
/// face.
constexpr double kStart = 1e-5;
/// Where a smooth normal sends a ray through the steps of voxels, it starts up to this many details away.
constexpr double kMaxLift = 2.5;
constexpr double kOcclusionReach = 0.1;
/// Share of light that a white object sends back.
constexpr double kWhite = 0.68;

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace

Vec3 reflect(Vec3 direction, Vec3 normal) { return direction - normal * (2 * dot(direction, normal)); }

std::optional<Vec3> refract(Vec3 direction, Vec3 normal, double ratio) {
  const double cosine = -dot(direction, normal), k = 1 - ratio * ratio * (1 - cosine * cosine);
  if (k < 0) return std::nullopt;
  return direction * ratio + normal * (ratio * cosine - std::sqrt(k));
}

Radiance::Radiance(const Caster& caster, const Lighting& lighting, const Environment& environment, Vec3 view)
    : caster_(caster),
      lighting_(lighting),
      environment_(environment),
      view_(view),
      reach_(kOcclusionReach * length(caster.object_box().extent())) {}

Vec3 Radiance::of_hit(const Ray& ray, const Hit& hit, Rng& rng) const {
  if (lighting_.ior > 0) return glass(ray, hit);
  if (lighting_.bounces > 0) return mirror(ray, hit, rng);
  return matt(ray, hit, rng);
}

Vec3 Radiance::facing_normal(const Ray& ray, const Hit& hit) const {
  const Vec3 n = caster_.shading_normal(hit);
  if (dot(n, ray.direction) < 0) return n;
  // Seen from behind its smooth normal: the face itself is met from the front, unless the ray began inside.
  return dot(hit.face_normal, ray.direction) < 0 ? hit.face_normal : -normalize(ray.direction);
}

bool Radiance::leave(const Hit& hit, Vec3 point, Vec3 normal, Vec3& start) const {
  const double detail = caster_.detail();
  start = point + hit.face_normal * (kStart * detail);
  if (!caster_.inside(start)) return true;
  for (double lift = 0.5; lift <= kMaxLift; lift += 0.5) {
    start = point + normal * (lift * detail);
    if (!caster_.inside(start)) return true;
  }
  return false;
}

double Radiance::open_sky(Vec3 point, Vec3 normal, Rng& rng) const {
  if (lighting_.occlusion_rays == 0) return 1;
  const Vec3 side = normalize(std::abs(normal.x) < 0.7 ? cross(normal, {1, 0, 0}) : cross(normal, {0, 1, 0}));
  const Vec3 other = cross(normal, side);
  std::uint32_t open = 0;
  const double offset = rng.uniform();
  for (std::uint32_t k = 0; k < lighting_.occlusion_rays; ++k) {
    // By the cosine; one coordinate stratified.
    const double r2 = (k + rng.uniform()) / lighting_.occlusion_rays;
    const double turn = 2 * std::numbers::pi * (0.618033988749895 * k + offset), r = std::sqrt(r2);
    const Vec3 d = side * (r * std::cos(turn)) + other * (r * std::sin(turn)) + normal * std::sqrt(1 - r2);
    Hit hit;
    open += !caster_.first_hit({point, d}, hit) || hit.t > reach_;
  }
  return double(open) / lighting_.occlusion_rays;
}

Vec3 Radiance::matt(const Ray& ray, const Hit& hit, Rng& rng) const {
  const Vec3 normal = facing_normal(ray, hit), point = ray.origin + ray.direction * hit.t;
  Vec3 start;
  const bool free = leave(hit, point, normal, start);
  const double sky = free ? open_sky(start, normal, rng) : 0;
  const Vec3 toward = -view_;
  double light = (0.10 + 0.08 * (0.5 + 0.5 * normal.y)) * sky;
  if (lighting_.light) {
    const Vec3 d = normalize(*lighting_.light);
    Hit blocker;
    const double cosine = dot(normal, d);
    if (free && cosine > 0 && !caster_.first_hit({start, d}, blocker)) light += 0.9 * cosine;
  } else {
    const Vec3 key =
        normalize(normalize(cross(view_, Vec3{0, 1, 0})) * -0.6 + Vec3{0, 0.9, 0} + toward * 0.7);
    light += (0.72 * std::max(0.0, dot(normal, key)) + 0.18 * std::max(0.0, dot(normal, toward))) * sky;
  }
  return caster_.color(hit, point) * (kWhite * light);
}

Vec3 Radiance::mirror(Ray ray, Hit hit, Rng& rng) const {
  Vec3 sum, share{1, 1, 1};
  for (std::uint32_t bounce = 0;; ++bounce) {
    if (lighting_.reflectivity < 1)
      sum = sum + times(share, matt(ray, hit, rng)) * (1 - lighting_.reflectivity);
    share = share * lighting_.reflectivity;
    const Vec3 normal = facing_normal(ray, hit), point = ray.origin + ray.direction * hit.t;
    Vec3 direction = normalize(reflect(ray.direction, normal)), start;
    if (!leave(hit, point, normal, start)) break;
    ray = {start, direction};
    if (bounce + 1 >= lighting_.bounces || !caster_.first_hit(ray, hit)) break;
  }
  // Past the last bounce that is followed, and in a crevice that no ray leaves, the environment is taken as
  // seen.
  return sum + times(share, environment_.radiance(ray.direction));
}

Vec3 Radiance::glass(Ray ray, Hit hit) const {
  const double nudge = kStart * caster_.detail();
  bool inside = false;
  Vec3 tint{1, 1, 1};
  for (std::uint32_t event = 0; event < lighting_.events; ++event) {
    const Vec3 point = ray.origin + ray.direction * hit.t;
    const Vec3 face = dot(hit.face_normal, ray.direction) < 0 ? hit.face_normal : -hit.face_normal;
    Vec3 normal = caster_.shading_normal(hit);
    if (inside) normal = -normal;
    if (dot(normal, ray.direction) >= 0) normal = face;  // smooth normals can face away at steps
    if (event == 0) tint = caster_.color(hit, point);
    const auto refracted = refract(ray.direction, normal, inside ? lighting_.ior : 1 / lighting_.ior);
    Vec3 direction = normalize(refracted ? *refracted : reflect(ray.direction, normal));
    const bool crosses = refracted.has_value();
    // The face has its own mind at steps of voxels: a ray that crosses must go through it, one that is
    // reflected back.
    if ((dot(direction, face) < 0) != crosses)
      direction = normalize(direction - face * (1.001 * dot(direction, face)));
    inside = inside != crosses;
    ray = {point + face * (crosses ? -nudge : nudge), direction};
    if (inside ? !caster_.first_exit(ray, hit) : !caster_.first_hit(ray, hit)) {
      if (!inside) break;
      inside = false;  // the start fell beside a corner of the object: the ray goes on outside
      if (!caster_.first_hit(ray, hit)) break;
    }
  }
  return times(tint, environment_.radiance(ray.direction));
}

}  // namespace mesocell
