#include "sdk/trace/beam.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/trace/cell_scene.h"
#include "sdk/trace/exact.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Bounds like those that squares of pixels have, wide ones, and points.
Beam random_beam(Rng& rng, const BeamGrid& grid) {
  Beam beam;
  beam.axis = rng.below(3);
  beam.octant = rng.below(8);
  const double wide = std::ldexp(1.0, int(rng.below(8)) - 5), bent = std::ldexp(1.0, -int(rng.below(12)));
  for (std::size_t a = 0; a < 3; ++a) {
    // Before the grid, on its border, within, and beside it.
    beam.low[a] = rng.below(6) == 0 ? 0 : rng.uniform(-grid.size[a], grid.size[a]);
    if (rng.below(4) == 0) beam.low[a] = std::floor(beam.low[a]);
    if (rng.below(16) == 0) beam.low[a] *= 0x1p30;
    beam.high[a] = beam.low[a] + rng.below(3) * rng.uniform() * wide;
    beam.slope_low[a] = rng.below(3) * rng.uniform();
    if (rng.below(8) == 0) beam.slope_low[a] = rng.uniform(0, 15);
    beam.slope_high[a] = beam.slope_low[a] + rng.below(3) * rng.uniform() * bent;
  }
  beam.slope_low[beam.axis] = beam.slope_high[beam.axis] = 1;
  return beam;
}

/// A ray of the beam, at its bounds as often as not.
Ray ray_of(Rng& rng, const Beam& beam, const BeamGrid& grid) {
  const auto between = [&](double low, double high) {
    const std::uint32_t kind = rng.below(4);
    return kind == 0 ? low : kind == 1 ? high : std::min(rng.uniform(low, high), high);
  };
  Ray ray;
  for (std::size_t a = 0; a < 3; ++a) {
    const double o = between(beam.low[a], beam.high[a]),
                 slope = between(beam.slope_low[a], beam.slope_high[a]);
    const bool rises = beam.octant >> a & 1;
    ray.origin[a] = rises ? o : grid.size[a] - o;
    ray.direction[a] = rises ? slope : -slope;
  }
  return ray;
}

struct Found {
  std::size_t misses = 0, later = 0;
};

/// No ray of a beam hits anything before it passes the plane, or at all where the beam misses.
Found check(const CellObject& object, std::uint64_t seed, int beams) {
  const CellScene scene(object);
  PacketScene grid;
  REQUIRE(scene.packets(grid));
  const auto caster = make_exact_caster(object);
  Rng rng(seed);
  Found found;
  for (int k = 0; k < beams; ++k) {
    const Beam narrow = random_beam(rng, grid);
    // As it is made of rays: with room for rounding.
    Beam beam = narrow;
    for (std::size_t a = 0; a < 3; ++a) {
      const double room = 0x1p-20 * (1 + 0x1p-20 * std::abs(beam.low[a]));
      beam.low[a] -= room;
      beam.high[a] += room;
    }
    const BeamStart start = find_start(grid, beam);
    const bool rises = beam.octant >> beam.axis & 1;
    const auto mirrored = [&](double x) { return rises ? x : grid.size[beam.axis] - x; };
    found.misses += start.misses;
    if (!start.misses) {
      REQUIRE(start.axis == beam.axis);
      found.later += mirrored(start.plane) > std::max(beam.high[beam.axis], 0.0);
    }
    for (int r = 0; r < 20; ++r) {
      const Ray ray = ray_of(rng, narrow, grid);
      Hit hit;
      if (!caster->first_hit(ray, hit)) continue;
      INFO("beam " << k << ", ray " << r);
      REQUIRE_FALSE(start.misses);
      // On the axis the speed is 1. Half a voxel before the plane all was empty.
      const double at = mirrored(ray.origin[beam.axis]) + hit.t;
      REQUIRE(at >= mirrored(start.plane) + 0.5 - 1e-6 * (1 + 0x1p-20 * std::abs(hit.t)));
    }
  }
  return found;
}

}  // namespace

TEST_CASE("no ray of a beam meets anything before the beam's start") {
  Found found;
  std::uint64_t seed = 1;
  for (const char* recipe :
       {"voronoi:cells=40,resolution=8,seed=1", "spheres:cells=30,resolution=20,seed=2",
        "voronoi:cells=60,resolution=7x9x5,seed=3", "voronoi:cells=50,resolution=32,seed=4"})
    for (const double share : {0.01, 0.3}) {
      Rng rng(seed);
      const CellObject object = random_object(rng, recipe, {5, 4, 6}, share);
      INFO(recipe << ", share " << share);
      const Found of = check(object, ++seed, 4000);
      found.misses += of.misses;
      found.later += of.later;
    }
  CHECK(found.misses > 1000);
  CHECK(found.later > 1000);
}

TEST_CASE("beams through grids of few full tiles, of one, and of none") {
  for (const Index3& tiles : {Index3{40, 30, 50}, Index3{300, 1, 2}, Index3{1, 1, 1}})
    for (const std::uint32_t rare : {300u, 1u, 0u}) {
      Rng rng(7);
      const CellObject object =
          make_blocks(tiles, 4 + 4 * rng.below(2), [&](auto...) { return rare > 0 && rng.below(rare) == 0; });
      INFO(tiles[0] << " tiles along x, one of " << rare);
      const Found found = check(object, 8, 3000);
      if (rare != 1) CHECK(found.misses > 100);
      if (rare == 0) CHECK(found.later == 0);
      if (rare == 300 && tiles[1] > 1) CHECK(found.later > 100);
    }
}
