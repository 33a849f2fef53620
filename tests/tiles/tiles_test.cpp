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
#include "sdk/tiles/seed_search.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

using WidePlace = std::array<std::int64_t, 3>;

/// A voxel's instance, as its cell (0: empty) and the tile of the instance's seed.
struct Instance {
  std::uint32_t cell = 0;
  WidePlace seed_tile{};
};

/// A distance as its metric defines it, from scratch. `d` in voxels.
double distance(const Seed& seed, SeedMetric metric, const std::array<double, 3>& d) {
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  if (metric == SeedMetric::kAdditive) return length - seed.weight / kTileUnit;
  if (metric == SeedMetric::kMultiplicative) return length / seed.weight;
  if (metric == SeedMetric::kEuclidean) return length;
  double sum = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    double u = 0;
    for (std::size_t c = 0; c < 3; ++c) u += seed.stretch[3 * r + c] * d[c];
    sum += u * u;
  }
  return std::sqrt(sum);
}

/// All seed images up to `reach` tiles away, with their distance from a voxel's centre.
struct Ranked {
  double distance;
  Instance instance;
};
std::vector<Ranked> ranked_images(const std::vector<Seed>& seeds, SeedMetric metric, const Index3& r,
                                  const WidePlace& voxel, std::int64_t reach) {
  std::vector<Ranked> all;
  for (std::uint32_t c = 0; c < seeds.size(); ++c)
    for (std::int64_t z = -reach; z <= reach; ++z)
      for (std::int64_t y = -reach; y <= reach; ++y)
        for (std::int64_t x = -reach; x <= reach; ++x) {
          const WidePlace tile{x, y, z};
          std::array<double, 3> d{};
          for (std::size_t a = 0; a < 3; ++a)
            d[a] = double(voxel[a]) + 0.5 - double(seeds[c].at[a]) / kTileUnit - double(tile[a] * r[a]);
          all.push_back({distance(seeds[c], metric, d), {c + 1, tile}});
        }
  // Stable: of equal ones the lower cell comes first, then the image of lesser (z, y, x).
  std::stable_sort(all.begin(), all.end(),
                   [](const Ranked& p, const Ranked& q) { return p.distance < q.distance; });
  return all;
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
        const Instance i = instance_of(WidePlace{x, y, z});
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

TEST_CASE("a Voronoi tile gives each voxel to the nearest image of its seed, in every metric") {
  struct Case {
    const char* name;
    SeedMetric metric;
    std::int64_t reach;  // farther than the generator looks
  };
  for (const Case& c :
       {Case{"euclidean", SeedMetric::kEuclidean, 2}, Case{"anisotropic", SeedMetric::kAnisotropic, 3},
        Case{"additive", SeedMetric::kAdditive, 2}, Case{"multiplicative", SeedMetric::kMultiplicative, 2}})
    for (const Index3 resolution : {Index3{4, 4, 4}, Index3{13, 13, 13}, Index3{9, 16, 12}})
      for (const std::uint32_t cells : {1u, 2u, 8u, 20u}) {
        INFO(c.name << " " << resolution[0] << " " << cells);
        GeneratorOptions options{.resolution = resolution,
                                 .cells = cells,
                                 .seed = 77 + cells,
                                 .recipe = {"", {{"metric", c.name}}}};
        TileReport report;
        const Result<TileMap> tile = make_voronoi_tile(options, &report);
        REQUIRE(tile.ok());
        CHECK(tile->cell_count + report.dropped_cells == cells);
        const std::vector<Seed> seeds = random_seeds(options, c.metric);
        check_homes(*tile, [&](const WidePlace& v) {
          return ranked_images(seeds, c.metric, resolution, v, c.reach)[0].instance;
        });
      }
}

TEST_CASE("a tie goes to the lower cell and the lesser image") {
  // The centre of a tile of one even side is as near to a seed in its corner as to three images of it.
  Index3 even{4, 4, 4};
  TileBuilder builder(even, 2);
  const std::vector<Seed> seeds{{{0, 0, 2048}}, {{0, 0, 2048}}};
  const SeedSearch search(seeds, SeedMetric::kEuclidean, 1, even, builder);
  std::atomic<int> seen{0};
  CHECK(search.run(2, nullptr, [&](const SeedSearch::Node& node) {
    for (std::size_t k = 1; k < node.images.size(); ++k)
      seen += node.images[k].code <= node.images[k - 1].code;
    seen += node.images.size() < 2;  // the second seed ties with the first everywhere
  }));
  CHECK(seen == 0);
}

TEST_CASE("a Worley tile cuts cells where a combination of distances exceeds a threshold") {
  struct Case {
    const char *combine, *threshold, *keep;
    std::array<double, 4> factors;
  };
  for (const Case& c :
       {Case{"f2-f1", "0.15", "above", {-1, 1, 0, 0}}, Case{"f1", "0.4", "below", {1, 0, 0, 0}},
        Case{"2*f3-f1+0.5*f4", "1.5", "above", {-1, 0, 2, 0.5}}})
    for (const std::uint32_t cells : {2u, 9u}) {
      const Index3 resolution{12, 10, 11};
      GeneratorOptions options{
          .resolution = resolution,
          .cells = cells,
          .seed = 5,
          .recipe = {"", {{"combine", c.combine}, {"threshold", c.threshold}, {"keep", c.keep}}}};
      const Result<TileMap> tile = make_worley_tile(options, nullptr);
      REQUIRE(tile.ok());
      const std::vector<Seed> seeds = random_seeds(options, SeedMetric::kEuclidean);
      const double limit = std::stod(c.threshold) * mean_spacing(options) / kTileUnit;
      check_homes(*tile, [&](const WidePlace& v) {
        const std::vector<Ranked> all = ranked_images(seeds, SeedMetric::kEuclidean, resolution, v, 2);
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k) sum += c.factors[k] * all[k].distance;
        return (sum > limit) == (std::string(c.keep) == "above") ? all[0].instance : Instance{};
      });
    }
}

TEST_CASE("bricks lie in running bond, each of the same size, with mortar between") {
  const Result<TileMap> tile = make_bricks_tile(
      {.resolution = {32, 32, 16}, .cells = 8, .recipe = {"", {{"mortar", "0.25"}, {"courses", "4"}}}},
      nullptr);
  REQUIRE(tile.ok());
  CHECK(tile->cell_count == 8);
  // A course is 8 voxels high, a quarter of them mortar; a brick is 16 long, 14 without its mortar.
  check_homes(*tile, [](const WidePlace& v) {
    const std::int64_t course = v[1] / 8;
    if (v[1] % 8 < 2 || v[2] < 2) return Instance{};
    const std::int64_t along = v[0] - (course % 2) * 8, brick = along < 0 ? -1 : along / 16;
    if (along - brick * 16 < 2) return Instance{};
    return Instance{std::uint32_t(course * 2 + (brick < 0 ? 1 : brick) + 1), {brick < 0 ? -1 : 0, 0, 0}};
  });
}

TEST_CASE("ellipsoids are disjoint, flat and turned") {
  const Index3 resolution{48, 48, 48};
  const Result<TileMap> tile =
      make_ellipsoids_tile({.resolution = resolution, .cells = 6, .seed = 3}, nullptr);
  const Result<TileMap> balls = make_spheres_tile({.resolution = resolution, .cells = 6, .seed = 3}, nullptr);
  REQUIRE(tile.ok());
  CHECK(tile->cell_count == 6);
  std::uint64_t fewer = 0;
  for (std::uint64_t i = 0; i < tile->voxel_count(); ++i) {
    const std::uint32_t id = tile->id(i), ball = balls->id(i);
    fewer += ball != 0 && id == 0;
    if (id == 0) continue;
    REQUIRE(ball != 0);  // each lies within its sphere
    REQUIRE(tile->pieces[id - 1].cell == balls->pieces[ball - 1].cell);
  }
  CHECK(fewer > 1000);
  const Result<TileMap> round = make_ellipsoids_tile(
      {.resolution = resolution, .cells = 6, .seed = 3, .recipe = {"", {{"flatness", "0"}}}}, nullptr);
  std::uint64_t differ = 0;
  for (std::uint64_t i = 0; i < tile->voxel_count(); ++i)
    differ += (round->id(i) == 0) != (balls->id(i) == 0);
  CHECK(double(differ) < 0.001 * double(tile->voxel_count()));  // turning a sphere rounds its surface
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
      std::map<std::uint32_t, std::set<WidePlace>> cell_voxels;
      std::uint64_t empty = 0;
      for (std::uint32_t z = 0; z < resolution[2]; ++z)
        for (std::uint32_t y = 0; y < resolution[1]; ++y)
          for (std::uint32_t x = 0; x < resolution[0]; ++x) {
            const std::uint32_t id = tile->id(tile->voxel_index(x, y, z));
            empty += id == 0;
            if (id == 0) continue;
            const Piece& p = tile->pieces[id - 1];
            cell_voxels[p.cell].insert(WidePlace{std::int64_t(x) - p.home[0] * std::int64_t(resolution[0]),
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
        WidePlace low = *voxels.begin(), high = low;
        for (const WidePlace& v : voxels)
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
    const Result<Recipe> spec = parse_recipe(recipe);
    const Result<TileMap> one = make_tile(*spec, 1), three = make_tile(*spec, 3);
    REQUIRE(one.ok());
    CHECK(*one == *three);
  }
  CHECK_FALSE(*make_tile(*parse_recipe("voronoi:resolution=16,seed=1")) ==
              *make_tile(*parse_recipe("voronoi:resolution=16,seed=2")));
}

TEST_CASE("the greatest number of cells, and of voxels along an axis") {
  TileReport report;
  const Result<TileMap> many = make_tile(*parse_recipe("voronoi:cells=65535,resolution=64"), 0, &report);
  REQUIRE(many.ok());
  CHECK(many->cell_count + report.dropped_cells == 65535);
  CHECK(many->cell_count > 60000);
  CHECK(many->id_bytes == 4);
  const Result<TileMap> balls = make_tile(*parse_recipe("spheres:cells=65535,resolution=128"));
  REQUIRE(balls.ok());
  CHECK(balls->cell_count > 65000);
  const Result<TileMap> wide = make_tile(*parse_recipe("voronoi:cells=3,resolution=1024x4x5"));
  REQUIRE(wide.ok());
  CHECK(wide->resolution == Index3{1024, 4, 5});
}

TEST_CASE("cells that get no voxel are left out and counted") {
  TileReport report;
  const Result<TileMap> tile = make_tile(*parse_recipe("voronoi:cells=64,resolution=4"), 0, &report);
  REQUIRE(tile.ok());
  CHECK(report.dropped_cells > 0);
  CHECK(tile->cell_count == 64 - report.dropped_cells);
}

TEST_CASE("making a tile can be cancelled") {
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  for (const char* recipe :
       {"voronoi:resolution=64", "spheres:resolution=64", "worley:resolution=64", "bricks:resolution=64"})
    CHECK(make_tile(*parse_recipe(recipe), 2, nullptr, &progress).error().code == ErrorCode::kCancelled);
}
