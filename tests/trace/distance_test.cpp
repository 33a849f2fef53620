#include "sdk/trace/distance.h"

#include <cmath>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/measure/tracing_error.h"
#include "sdk/trace/cell_object_caster.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/linear.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

std::vector<Ray> rays_at(double n, std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 o{rng.uniform(-n, 2 * n), rng.uniform(-n, 2 * n), rng.uniform(-n, 2 * n)};
    const Vec3 target{rng.uniform(0, n), rng.uniform(0, n), rng.uniform(0, n)};
    rays.push_back({o, normalize(target - o)});
  }
  return rays;
}

/// Slats of one voxel's thickness across x, eight voxels apart and eight high, with empty tiles above z = 8.
CellObject slats() {
  CellObject object;
  object.tile.resolution = {8, 8, 8};
  object.tile.cell_count = 2;
  object.tile.pieces = {{1, {}}, {2, {}}};
  for (int i = 0; i < 512; ++i) object.tile.voxel_ids.push_back(i % 8 == 3 ? 1 : 2);
  object.grid = {{0, 0, 0}, 1, {40, 40, 2}};
  object.membership.tiles = object.grid.tiles;
  object.membership.cell_count = 2;
  object.membership.blocks = {std::uint8_t(std::uint32_t(Tag::kInside) | std::uint32_t(Tag::kOutside) << 2)};
  object.membership.blocks.resize(object.membership.block_bytes());
  for (int k = 0; k < 3200; ++k)
    object.membership.entries.push_back(k < 1600 ? MembershipMap::kFirstBlock : std::uint32_t(Tag::kOutside));
  return object;
}

/// From above the slats across them, 70° to 87° from the vertical.
std::vector<Ray> grazing_rays() {
  Rng rng(2);
  std::vector<Ray> rays;
  for (int k = 0; k < 2000; ++k)
    rays.push_back({{rng.uniform(10, 30), rng.uniform(10, 310), 8.5},
                    normalize({1, rng.uniform(-0.1, 0.1), -std::exp(rng.uniform(-3, -1))})});
  return rays;
}

}  // namespace

TEST_CASE("distance stepping is late by its threshold at most, but for corners it cuts") {
  Rng rng(3);
  for (const char* recipe : {"voronoi:cells=4,resolution=8", "spheres:cells=5,resolution=16,seed=3"}) {
    const CellObject object = random_object(rng, recipe, {3, 4, 3}, 0.3);
    const auto exact = make_exact_caster(object), distance = make_distance_caster(object);
    // A step of the threshold on the greatest axis is up to sqrt(3) times as long.
    const double step = double(kDistanceThreshold) * std::sqrt(3.0) + 1e-4;
    const TracingError e = measure_tracing_error(*exact, *distance, rays_at(40, 100000, 4), step);
    REQUIRE(e.hits > 10000);
    CHECK(double(e.late + e.missed) < 0.02 * double(e.hits));
    CHECK(e.late + e.missed > 0);
    CHECK(double(e.false_hits) < 1e-3 * double(e.hits));
  }
}

TEST_CASE("distance stepping tells voxels that are inside, cells and exits") {
  Rng rng(8);
  const CellObject object = random_object(rng, "voronoi:cells=4,resolution=8", {3, 3, 3}, 0.3);
  const auto exact = make_exact_caster(object), distance = make_distance_caster(object);
  int same = 0, hits = 0, exits = 0;
  for (const Ray& ray : rays_at(24, 20000, 9)) {
    Hit a, b;
    if (!exact->first_hit(ray, a) || !distance->first_hit(ray, b)) continue;
    ++hits;
    REQUIRE(distance->inside(
        {double(b.element[0]) + 0.5, double(b.element[1]) + 0.5, double(b.element[2]) + 0.5}));
    same += a.element == b.element && a.label == b.label && a.instance == b.instance &&
            a.face_normal == b.face_normal;
    const Ray within{ray.origin + ray.direction * (b.t + 1e-3), ray.direction};
    if (!exact->first_exit(within, a)) continue;
    REQUIRE(distance->first_exit(within, b));
    exits += std::abs(a.t - b.t) < 0.06;
  }
  CHECK(same > hits * 97 / 100);
  CHECK(exits > hits * 97 / 100);
  Hit hit;
  CHECK_FALSE(distance->first_hit({{1, 1, 1}, {0, 0, 0}}, hit));
  CHECK_FALSE(distance->first_hit({{std::nan(""), 1, 1}, {0, 0, 1}}, hit));
}

TEST_CASE("a step that depends on the angle finds what a fixed one passes by at grazing angles") {
  const CellObject object = slats();
  const auto exact = make_exact_caster(object);
  const std::vector<Ray> rays = grazing_rays();
  const auto lost = [&](const char* method) {
    const auto caster = make_cell_object_caster(object, method);
    REQUIRE(caster.ok());
    const TracingError e = measure_tracing_error(*exact, **caster, rays, 1);
    CHECK(e.hits == rays.size());
    CHECK(e.false_hits == 0);
    return e.missed + e.late;
  };
  const auto fixed = lost("linear:1/2"), by_angle = lost("linear:1/2:angle");
  CHECK(fixed > 1000);
  CHECK(by_angle < fixed / 4);
  // Straight down the cosine is 1, and the rules are one.
  Rng rng(3);
  for (int k = 0; k < 100; ++k) {
    const Ray ray{{rng.uniform(0, 320), rng.uniform(0, 320), 20}, {0, 0, -1}};
    Hit a, b;
    const bool hit = make_linear_caster(object, 0.5)->first_hit(ray, a);
    REQUIRE(make_linear_caster(object, 0.5, LinearStep::kByAngle)->first_hit(ray, b) == hit);
    if (hit) CHECK(a.element == b.element);
  }
}

TEST_CASE("samples are counted, and shorter steps take more of them") {
  const CellObject object = slats();
  const std::vector<Ray> rays = grazing_rays();
  const auto steps = [&](const char* method) {
    return (*make_cell_object_caster(object, method))->count_steps(rays);
  };
  const auto coarse = steps("linear:1/8");
  CHECK(coarse > 2 * rays.size());
  CHECK(steps("linear:1/64") > 2 * coarse);
  CHECK(steps("linear:1/64") < 8 * coarse);
  CHECK(steps("linear:1/64:angle") > 2 * steps("linear:1/64"));
  CHECK(steps("distance") > 2 * rays.size());
  // Empty tiles are crossed at once: the first sample, the border, and some to near the slat.
  const Ray down[] = {{{3.5, 3.5, 15.5}, {0, 0, -1}}};
  CHECK(make_linear_caster(object, 1.0 / 64)->count_steps(down) < 20);
  CHECK(make_distance_caster(object)->count_steps(down) < 40);
}
