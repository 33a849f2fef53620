#include "converters/bench/ray_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/shade/radiance.h"

namespace mesocell {
namespace {

constexpr std::array<std::pair<RaySet, std::string_view>, 4> kSets = {{{RaySet::kPrimary, "primary"},
                                                                       {RaySet::kDiffuse, "diffuse"},
                                                                       {RaySet::kReflection, "reflection"},
                                                                       {RaySet::kShadow, "shadow"}}};
constexpr std::uint32_t kSquare = 8;
/// Off the face, voxels.
constexpr double kStart = 1.0 / 64;
/// From the box's centre, in its longest sides: beyond the box, so that what a ray hits is before it.
constexpr Vec3 kLight{1.5, 2, -1.2};

std::vector<Ray> primary_rays(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  std::vector<Ray> rays;
  rays.reserve(std::size_t{width} * height);
  for (std::uint32_t top = 0; top < height; top += kSquare)
    for (std::uint32_t left = 0; left < width; left += kSquare)
      for (std::uint32_t y = top; y < std::min(top + kSquare, height); ++y)
        for (std::uint32_t x = left; x < std::min(left + kSquare, width); ++x)
          rays.push_back(camera.ray(x + 0.5, y + 0.5));
  return rays;
}

Vec3 cosine_direction(Vec3 normal, Rng& rng) {
  const Vec3 side = normalize(std::abs(normal.x) < 0.7 ? cross(normal, {1, 0, 0}) : cross(normal, {0, 1, 0}));
  const Vec3 other = cross(normal, side);
  const double r2 = rng.uniform(), r = std::sqrt(r2), turn = 2 * std::numbers::pi * rng.uniform();
  return side * (r * std::cos(turn)) + other * (r * std::sin(turn)) + normal * std::sqrt(1 - r2);
}

/// The ray that follows a hit; none if the first one began inside.
std::optional<Ray> next_ray(RaySet set, const Caster& exact, const Ray& ray, Vec3 light, Rng& rng) {
  Hit hit;
  if (!exact.first_hit(ray, hit) || hit.face_normal == Vec3{}) return std::nullopt;
  const Vec3 face = hit.face_normal;
  const Vec3 start = ray.origin + ray.direction * hit.t + face * (kStart * exact.detail());
  Vec3 normal = exact.shading_normal(hit);
  if (dot(normal, ray.direction) >= 0) normal = face;
  Vec3 direction = set == RaySet::kDiffuse      ? cosine_direction(normal, rng)
                   : set == RaySet::kReflection ? reflect(ray.direction, normal)
                                                : light - start;
  // What a smooth normal sends into the face goes off it as steeply; a light behind it is not asked for.
  const double into = dot(direction, face);
  if (into <= 0 && set == RaySet::kShadow) return std::nullopt;
  if (into < 0) direction = direction - face * (2 * into);
  return Ray{start, normalize(direction)};
}

}  // namespace

std::string_view ray_set_name(RaySet set) {
  for (const auto& [known, name] : kSets)
    if (known == set) return name;
  return {};
}

std::optional<RaySet> find_ray_set(std::string_view name) {
  for (const auto& [set, known] : kSets)
    if (known == name) return set;
  return std::nullopt;
}

bool is_coherent(RaySet set) { return set == RaySet::kPrimary || set == RaySet::kShadow; }

std::vector<Ray> make_rays(RaySet set, const Caster& exact, const Camera& camera, std::uint32_t width,
                           std::uint32_t height, std::uint64_t seed, unsigned threads,
                           const Progress& progress) {
  const std::vector<Ray> primary = primary_rays(camera, width, height);
  if (set == RaySet::kPrimary) return primary;
  constexpr std::size_t kChunk = 4096;
  const Box3 box = exact.object_box();
  const Vec3 extent = box.extent();
  const Vec3 light = box.min + extent * 0.5 + kLight * std::max({extent.x, extent.y, extent.z});
  std::vector<std::vector<Ray>> parts((primary.size() + kChunk - 1) / kChunk);
  const bool done = parallel_for(
      parts.size(), threads,
      [&](std::size_t part, unsigned) {
        const std::size_t end = std::min(primary.size(), (part + 1) * kChunk);
        for (std::size_t k = part * kChunk; k < end; ++k) {
          // Every ray has numbers of its own, whatever the others hit.
          Rng rng(Rng(seed + k).next());
          if (const auto ray = next_ray(set, exact, primary[k], light, rng)) parts[part].push_back(*ray);
        }
      },
      &progress, "rays");
  std::vector<Ray> rays;
  if (!done) return rays;
  for (const std::vector<Ray>& part : parts) rays.insert(rays.end(), part.begin(), part.end());
  return rays;
}

}  // namespace mesocell
