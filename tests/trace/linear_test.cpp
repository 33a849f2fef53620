#include "sdk/trace/linear.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/measure/tracing_error.h"
#include "sdk/shade/camera.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/cell_object_caster.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/walk.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

CellObject slab_of_spheres(std::uint32_t resolution) {
  const TileMap tile =
      *make_tile(*parse_recipe("spheres:cells=8,seed=1,resolution=" + std::to_string(resolution)));
  Result<CellObject> object =
      author_cell_object(make_box({0, 0, 0}, {4, 4, 1}), tile, {.grid = {.tiles = 16}});
  REQUIRE(object.ok());
  return std::move(*object);
}

struct View {
  const char* name;
  Vec3 eye, up;
};
constexpr View kViews[] = {{"frontal", {2, 2, 9}, {0, 1, 0}}, {"grazing", {12, 2, 1.3}, {0, 0, 1}}};

std::vector<Ray> rays_of(const CellObject& object, const View& view) {
  const Box3 box{to_vec3(object.grid.box_min), to_vec3(object.box_max())};
  const Result<Camera> camera =
      Camera::make(box, {.eye = view.eye, .up = view.up, .fov_degrees = 30}, 320, 240);
  REQUIRE(camera.ok());
  std::vector<Ray> rays;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) rays.push_back(camera->ray(x + 0.5, y + 0.5));
  return rays;
}

/// How long the ray stays in INSIDE voxels from an exact hit on, metres.
double chord(const CellObject& object, const Ray& ray, const Hit& hit) {
  WalkRay walk;
  const Vec3 corner = to_vec3(object.grid.box_min);
  REQUIRE(WalkRay::make({(ray.origin - corner) / object.grid.voxel_edge, ray.direction}, walk));
  WalkPlace place{hit.element, 0, -1};
  const auto inside = [&](const Voxel& v) {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < 0 || v[a] >= std::int64_t(object.grid.tiles[a]) * object.tile.resolution[a]) return false;
    return is_inside(object, v);
  };
  while (inside(place.voxel)) {
    const Voxel v = place.voxel;
    leave_box(walk, v, {v[0] + 1, v[1] + 1, v[2] + 1}, place);
  }
  return place.t * walk.scale * object.grid.voxel_edge - hit.t;
}

}  // namespace

TEST_CASE("linear search is late and misses, the more the longer its step and the flatter the view",
          "[slow]") {
  std::printf(
      "linear search against exact tracing, spheres in a slab; shares of the exact hits\n"
      "tile  view     step   hits   late %%  missed %%  max delay (tile edges)\n");
  for (const std::uint32_t resolution : {32u, 128u}) {
    const CellObject object = slab_of_spheres(resolution);
    const auto exact = make_exact_caster(object);
    const double tile_edge = object.grid.voxel_edge * resolution;
    for (const View& view : kViews) {
      const std::vector<Ray> rays = rays_of(object, view);
      double missed_before = 1;
      for (const int steps : {16, 64, 256, 512}) {
        const auto linear = make_linear_caster(object, 1.0 / steps);
        const TracingError e = measure_tracing_error(*exact, *linear, rays, tile_edge / steps);
        std::printf("%4u  %s  1/%-3d  %6llu  %6.3f  %8.4f  %.5f\n", resolution, view.name, steps,
                    (unsigned long long)e.hits, 100.0 * double(e.late) / double(e.hits),
                    100.0 * double(e.missed) / double(e.hits), e.max_delay / tile_edge);
        REQUIRE(e.hits > 5000);
        CHECK(e.near == 0);
        CHECK(e.false_hits == 0);
        const double missed = double(e.missed) / double(e.hits);
        CHECK(missed <= missed_before);
        missed_before = missed;
        // At 1/512 of 32 voxels, a sixteenth of a voxel, few rays cut a corner by less than a step.
        if (steps == 512 && resolution == 32) CHECK(double(e.late) <= 0.005 * double(e.hits - e.missed));
      }
    }
  }
}

TEST_CASE("what linear search passes by is thinner than its step") {
  const CellObject object = slab_of_spheres(32);
  const auto exact = make_exact_caster(object);
  for (const int steps : {16, 512}) {
    const double step = object.grid.voxel_edge * 32 / steps;
    const auto linear = make_linear_caster(object, 1.0 / steps);
    int passed = 0;
    for (const View& view : kViews)
      for (const Ray& ray : rays_of(object, view)) {
        Hit truth, found;
        if (!exact->first_hit(ray, truth)) continue;
        if (linear->first_hit(ray, found) && found.t <= truth.t + step) continue;
        ++passed;
        REQUIRE(chord(object, ray, truth) < step * (1 + 1e-9));
      }
    CHECK(passed > 20);
  }
}

TEST_CASE("linear search is never nearer than exact tracing") {
  Rng rng(3);
  for (const char* recipe : {"voronoi:cells=4,resolution=8", "spheres:cells=5,resolution=16,seed=3"}) {
    const CellObject object = random_object(rng, recipe, {3, 4, 3}, 0.3);
    const auto exact = make_exact_caster(object), linear = make_linear_caster(object, 1.0 / 512);
    std::vector<Ray> rays;
    for (std::size_t k = 0; k < repetitions(100000); ++k) {
      const Vec3 o{rng.uniform(-20, 60), rng.uniform(-20, 60), rng.uniform(-20, 60)};
      const Vec3 target{rng.uniform(0, 40), rng.uniform(0, 40), rng.uniform(0, 40)};
      rays.push_back({o, normalize(target - o)});
    }
    const TracingError e = measure_tracing_error(*exact, *linear, rays, object.tile.resolution[0] / 512.0);
    REQUIRE(e.hits > rays.size() / 10);
    CHECK(e.near == 0);
    CHECK(e.false_hits == 0);
    CHECK(double(e.late) <= 0.005 * double(e.hits - e.missed));
  }
}

TEST_CASE("methods are chosen by name, and wrong names are usage errors") {
  Rng rng(4);
  const CellObject object = random_object(rng, "voronoi:cells=2,resolution=4", {2, 2, 2}, 0.5);
  for (const char* good :
       {"exact", "linear:1/512", "linear:0.01", "linear:1", "linear:1/128:angle", "distance"})
    CHECK(make_cell_object_caster(object, good).ok());
  for (const char* bad : {"", "magic", "exact:1", "linear", "linear:", "linear:0", "linear:2", "linear:-1/8",
                          "linear:1/0", "linear:nan", "linear:1/512/2", "linear:1e-9",
                          "linear:1/8:", "linear:1/8:angel", "linear::angle", "distance:2"}) {
    const auto caster = make_cell_object_caster(object, bad);
    INFO(bad);
    REQUIRE_FALSE(caster.ok());
    CHECK(caster.error().code == ErrorCode::kUsage);
  }
}
