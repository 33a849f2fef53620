#include "sdk/trace/lod.h"

#include <cmath>
#include <map>

#include "sdk/trace/exact.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// A square of 8 × 8 pixels seen from `eye`, `pixel` radians apart.
std::vector<Ray> square(Vec3 eye, Vec3 to, double pixel) {
  const Vec3 forward = normalize(to - eye), right = normalize(cross(forward, {0.1, 1, 0.2})),
             up = cross(right, forward);
  std::vector<Ray> rays;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      rays.push_back({eye, normalize(forward + right * (pixel * (x - 3.5)) + up * (pixel * (y - 3.5)))});
  return rays;
}

}  // namespace

TEST_CASE("a coarser tile has the label of most voxels, and all tags") {
  Rng rng(1);
  for (const char* recipe :
       {"voronoi:cells=5,resolution=24x16x32,seed=3", "spheres:cells=3,resolution=16,seed=2"}) {
    const CellObject fine = random_object(rng, recipe, {2, 3, 2}, 0.3);
    for (unsigned level = 1; level <= 2; ++level) {
      const auto coarse = coarser(fine, level);
      REQUIRE(coarse);
      CHECK(coarse->membership == fine.membership);
      CHECK(coarse->box_max() == fine.box_max());
      const std::uint32_t f = 1u << level;
      for (std::uint32_t z = 0; z < coarse->tile.resolution[2]; ++z)
        for (std::uint32_t y = 0; y < coarse->tile.resolution[1]; ++y)
          for (std::uint32_t x = 0; x < coarse->tile.resolution[0]; ++x) {
            std::map<std::uint32_t, int> count;
            for (std::uint32_t k = 0; k < f * f * f; ++k)
              ++count[fine.tile.id(
                  fine.tile.voxel_index(x * f + k % f, y * f + k / f % f, z * f + k / f / f))];
            const std::uint32_t label = coarse->tile.id(coarse->tile.voxel_index(x, y, z));
            for (const auto& [id, n] : count)
              REQUIRE((n < count[label] || (n == count[label] && label <= id)));
          }
    }
  }
  const CellObject odd = random_object(rng, "voronoi:cells=2,resolution=20", {1, 1, 1}, 1);
  CHECK(coarser(odd, 2));
  CHECK_FALSE(coarser(odd, 3));  // 20 is not divisible by 8
  CHECK_FALSE(coarser(random_object(rng, "voronoi:cells=2,resolution=8", {1, 1, 1}, 1), 2));  // below 4
}

TEST_CASE("hits of a level are exact on that level, and its voxels no larger than a pixel") {
  Rng rng(2);
  const CellObject object = random_object(rng, "voronoi:cells=4,resolution=32,seed=5", {3, 3, 3}, 0.4);
  const auto lod = make_lod_caster(object, 1);
  const double pixel = 1e-3, n = 96;
  std::map<unsigned, int> seen;
  std::vector<CellObject> levels;
  for (unsigned level = 0; level < 4; ++level) {
    auto at_level = coarser(object, level);
    REQUIRE(at_level);
    levels.push_back(std::move(*at_level));
  }
  std::vector<decltype(make_exact_caster(object))> casters;
  for (const CellObject& at_level : levels) casters.push_back(make_exact_caster(at_level));
  for (int k = 0; k < 300; ++k) {
    // One metre a voxel: at 1000 metres one appears a pixel large.
    const Vec3 away = normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)});
    const double distance = 200 * std::pow(2, rng.uniform(0, 6));
    const Vec3 to{rng.uniform(0.2, 0.8) * n, rng.uniform(0.2, 0.8) * n, rng.uniform(0.2, 0.8) * n};
    const std::vector<Ray> rays = square(to + away * distance, to, pixel);
    std::vector<StreamHit> hits(rays.size()), exact(rays.size());
    lod->first_hits(rays, hits);
    const unsigned level = hits[0].level;
    REQUIRE(level < casters.size());
    ++seen[level];
    casters[level]->first_hits(rays, exact);
    for (std::size_t r = 0; r < rays.size(); ++r) {
      REQUIRE(hits[r].level == level);
      REQUIRE(hits[r].t == exact[r].t);
      REQUIRE(hits[r].element == exact[r].element);
      if (hits[r].hit()) REQUIRE((level == 0 || std::ldexp(1.0, int(level)) <= 1.001 * hits[r].t * pixel));
    }
    // Nor finer than it must be: the object's box is at most so far.
    if (level < 3) CHECK(std::ldexp(1.0, int(level) + 1) > (distance - 1.8 * n) * pixel * 0.99);
  }
  CHECK(seen.size() == 4);
}

TEST_CASE("near rays see the finest level, and a single ray tells its level") {
  Rng rng(3);
  const CellObject object = random_object(rng, "voronoi:cells=4,resolution=16,seed=5", {2, 2, 2}, 0.5);
  const auto lod = make_lod_caster(object, 1);
  const auto exact = make_exact_caster(object);
  int hits = 0;
  for (int k = 0; k < 1500; ++k) {
    const Ray ray{{rng.uniform(0, 32), rng.uniform(0, 32), rng.uniform(0, 32)},
                  normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)})};
    Hit a, b;
    REQUIRE(lod->first_hit(ray, a) == exact->first_hit(ray, b));
    if (!exact->first_hit(ray, b)) continue;
    ++hits;
    CHECK(a.level == 0);
    CHECK(a.t == b.t);
    CHECK(lod->shading_normal(a) == exact->shading_normal(b));
  }
  CHECK(hits > 100);
  Hit far;
  REQUIRE(lod->first_hit({{15, 14, -1e4}, {0, 0, 1}}, far) ==
          exact->first_hit({{15, 14, -1e4}, {0, 0, 1}}, far));
  if (lod->first_hit({{15, 14, -1e4}, {0, 0, 1}}, far)) CHECK(far.level == 2);
}
