#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "sdk/tiles/generators.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

using Place = std::array<std::int64_t, 3>;

/// A voxel's instance, as its cell (0: empty) and the tile of the instance's seed.
struct Instance {
  std::uint32_t cell = 0;
  Place seed_tile{};
};

/// The definition, voxel by voxel: the nearest of all seed images up to two tiles away, ties to the lower
/// cell, then to the lesser (z, y, x) image.
Instance nearest_seed(const std::vector<TilePoint>& seeds, const Index3& r, const Place& voxel) {
  Instance best;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (std::uint32_t c = 0; c < seeds.size(); ++c)
    for (std::int64_t z = -2; z <= 2; ++z)
      for (std::int64_t y = -2; y <= 2; ++y)
        for (std::int64_t x = -2; x <= 2; ++x) {
          const Place tile{x, y, z};
          std::int64_t d2 = 0;
          for (std::size_t a = 0; a < 3; ++a) {
            const std::int64_t d = 2 * 1024 * voxel[a] + 1024 - 2 * (seeds[c][a] + tile[a] * r[a] * 1024);
            d2 += d * d;
          }
          if (d2 < least) {
            least = d2;
            best = {c + 1, tile};
          }
        }
  return best;
}

/// Checks that pieces and home tiles say the same as `instance_of`, which knows each voxel's instance by its
/// seed.
template <typename F>
void check_homes(const TileMap& tile, F instance_of) {
  const Index3& r = tile.resolution;
  std::map<std::uint32_t, std::tuple<std::int64_t, std::int64_t, std::int64_t>> first;
  std::vector<Instance> instances;
  for (std::int64_t z = 0; z < r[2]; ++z)
    for (std::int64_t y = 0; y < r[1]; ++y)
      for (std::int64_t x = 0; x < r[0]; ++x) {
        const Instance i = instance_of(Place{x, y, z});
        instances.push_back(i);
        if (i.cell == 0) continue;
        const std::tuple<std::int64_t, std::int64_t, std::int64_t> place{
            z - i.seed_tile[2] * r[2], y - i.seed_tile[1] * r[1], x - i.seed_tile[0] * r[0]};
        const auto [at, added] = first.emplace(i.cell, place);
        if (!added && place < at->second) at->second = place;
      }
  std::map<std::uint32_t, std::uint32_t> number;  // cells without voxels are left out
  for (const auto& [cell, place] : first) number.emplace(cell, std::uint32_t(number.size() + 1));
  REQUIRE(tile.cell_count == number.size());
  const auto floor_div = [](std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
  for (std::uint64_t i = 0; i < tile.voxel_count(); ++i) {
    const std::uint32_t id = tile.id(i);
    if (instances[i].cell == 0) {
      REQUIRE(id == 0);
      continue;
    }
    REQUIRE(id > 0);
    REQUIRE(id <= tile.pieces.size());
    const Piece& p = tile.pieces[id - 1];
    REQUIRE(p.cell == number.at(instances[i].cell));
    const auto [z, y, x] = first.at(instances[i].cell);
    const std::array<std::int64_t, 3> home{floor_div(x, r[0]), floor_div(y, r[1]), floor_div(z, r[2])};
    for (std::size_t a = 0; a < 3; ++a) REQUIRE(p.home[a] == home[a] + instances[i].seed_tile[a]);
  }
  for (std::size_t k = 1; k < tile.pieces.size(); ++k) {
    const auto key = [](const Piece& p) { return std::tuple(p.cell, p.home[2], p.home[1], p.home[0]); };
    REQUIRE(key(tile.pieces[k - 1]) < key(tile.pieces[k]));
  }
  REQUIRE(tile.id_bytes == TileMap::id_bytes_for(tile.pieces.size()));
}

}  // namespace

TEST_CASE("a Voronoi tile gives each voxel to the nearest image of its seed") {
  for (const Index3 resolution : {Index3{4, 4, 4}, Index3{16, 16, 16}, Index3{23, 23, 23}, Index3{9, 20, 14}})
    for (const std::uint32_t cells : {1u, 2u, 8u, 40u})
      for (const std::uint64_t seed : {1u, 77u}) {
        GeneratorOptions options{.resolution = resolution, .cells = cells, .seed = seed};
        TileReport report;
        const Result<TileMap> tile = make_voronoi_tile(options, &report);
        REQUIRE(tile.ok());
        CHECK(tile->cell_count + report.dropped_cells == cells);
        const std::vector<TilePoint> seeds = random_tile_points(options, cells);
        check_homes(*tile, [&](const Place& v) { return nearest_seed(seeds, resolution, v); });
      }
}

TEST_CASE("one Voronoi cell fills the tile, in up to eight pieces, though it meets its own copies") {
  const Result<TileMap> tile =
      make_voronoi_tile({.resolution = {32, 32, 32}, .cells = 1, .seed = 3}, nullptr);
  REQUIRE(tile.ok());
  CHECK(tile->cell_count == 1);
  CHECK(tile->pieces.size() == 8);
  for (std::uint64_t i = 0; i < tile->voxel_count(); ++i) REQUIRE(tile->id(i) != 0);
}

TEST_CASE("spheres are disjoint, round and leave empty space") {
  for (const Index3 resolution : {Index3{16, 16, 16}, Index3{31, 31, 31}, Index3{40, 20, 28}})
    for (const std::uint32_t cells : {1u, 5u, 12u}) {
      GeneratorOptions options{.resolution = resolution, .cells = cells, .seed = 5};
      const Result<TileMap> tile = make_spheres_tile(options, nullptr);
      REQUIRE(tile.ok());
      CHECK(tile->cell_count == cells);
      // Gather each instance in its own coordinates, then compare it with a ball of the same extent.
      std::map<std::uint32_t, std::set<Place>> cell_voxels;
      std::uint64_t empty = 0;
      for (std::uint32_t z = 0; z < resolution[2]; ++z)
        for (std::uint32_t y = 0; y < resolution[1]; ++y)
          for (std::uint32_t x = 0; x < resolution[0]; ++x) {
            const std::uint32_t id = tile->id(tile->voxel_index(x, y, z));
            empty += id == 0;
            if (id == 0) continue;
            const Piece& p = tile->pieces[id - 1];
            cell_voxels[p.cell].insert(Place{std::int64_t(x) - p.home[0] * std::int64_t(resolution[0]),
                                             std::int64_t(y) - p.home[1] * std::int64_t(resolution[1]),
                                             std::int64_t(z) - p.home[2] * std::int64_t(resolution[2])});
          }
      const double fill = 1 - double(empty) / double(tile->voxel_count());
      // A quarter is filled before the spheres grow, unless a single one is stopped by its own image.
      const double side = std::min({resolution[0], resolution[1], resolution[2]});
      CHECK(fill >
            0.97 * std::min(0.25, 3.14159265 / 6 * side * side * side * cells / double(tile->voxel_count())));
      CHECK(fill < 0.75);
      for (const auto& [cell, voxels] : cell_voxels) {
        Place low = *voxels.begin(), high = low;
        for (const Place& v : voxels)
          for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], v[a]);
            high[a] = std::max(high[a], v[a]);
          }
        double diameter = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          const double d = double(high[a] - low[a] + 1);
          CHECK(std::abs(d - double(high[0] - low[0] + 1)) <= 1);
          diameter = std::max(diameter, d);
        }
        // The surface is uncertain by half a voxel on each side.
        const auto ball = [](double d) { return 3.14159265 / 6 * d * d * d; };
        CHECK(double(voxels.size()) <= ball(diameter + 1));
        CHECK(double(voxels.size()) >= ball(std::max(0.0, diameter - 1.5)));
      }
    }
}

TEST_CASE("a tile does not depend on the number of threads") {
  for (const char* recipe :
       {"voronoi:cells=30,resolution=40,seed=9", "spheres:cells=30,resolution=40,seed=9"}) {
    const Result<TileSpec> spec = parse_tile_spec(recipe);
    const Result<TileMap> one = make_tile(*spec, 1), three = make_tile(*spec, 3);
    REQUIRE(one.ok());
    CHECK(*one == *three);
  }
  CHECK_FALSE(*make_tile(*parse_tile_spec("voronoi:resolution=16,seed=1")) ==
              *make_tile(*parse_tile_spec("voronoi:resolution=16,seed=2")));
}

TEST_CASE("the greatest number of cells, and of voxels along an axis") {
  TileReport report;
  const Result<TileMap> many = make_tile(*parse_tile_spec("voronoi:cells=65535,resolution=64"), 0, &report);
  REQUIRE(many.ok());
  CHECK(many->cell_count + report.dropped_cells == 65535);
  CHECK(many->cell_count > 60000);
  CHECK(many->id_bytes == 4);
  const Result<TileMap> balls = make_tile(*parse_tile_spec("spheres:cells=65535,resolution=128"));
  REQUIRE(balls.ok());
  CHECK(balls->cell_count > 65000);
  const Result<TileMap> wide = make_tile(*parse_tile_spec("voronoi:cells=3,resolution=1024x4x5"));
  REQUIRE(wide.ok());
  CHECK(wide->resolution == Index3{1024, 4, 5});
}

TEST_CASE("cells that get no voxel are left out and counted") {
  TileReport report;
  const Result<TileMap> tile = make_tile(*parse_tile_spec("voronoi:cells=64,resolution=4"), 0, &report);
  REQUIRE(tile.ok());
  CHECK(report.dropped_cells > 0);
  CHECK(tile->cell_count == 64 - report.dropped_cells);
}

TEST_CASE("making a tile can be cancelled") {
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  for (const char* recipe : {"voronoi:resolution=64", "spheres:resolution=64"})
    CHECK(make_tile(*parse_tile_spec(recipe), 2, nullptr, &progress).error().code == ErrorCode::kCancelled);
}
