#include "sdk/surface/normals.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>

#include "format/cell_object_io.h"
#include "format/normal_map.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/tile_builder.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/exact.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

/// A tile of one cell: the voxels whose centres a predicate holds for.
template <typename F>
TileMap cell_of(std::uint32_t n, F inside) {
  TileBuilder builder({n, n, n}, 1);
  std::uint64_t i = 0;
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x, ++i)
        if (inside(Vec3{x + 0.5, y + 0.5, z + 0.5})) builder.set(i, builder.code(1, builder.image_index(0, 0, 0)));
  return builder.finish(1, nullptr);
}

/// RMS angles, degrees, of both rules against the true normal, over the boundary voxels that `counts` picks.
struct Errors {
  double neighbour = 0, gradient = 0;
  int voxels = 0;
};
template <typename N, typename C>
void add_errors(const TileMap& tile, N truth, C counts, Errors& sum) {
  const CellNormals normals(tile);
  const std::vector<std::uint8_t> boundary = boundary_voxels(tile);
  const std::uint32_t n = tile.resolution[0];
  for (std::uint64_t i = 0; i < boundary.size(); ++i) {
    if (!boundary[i]) continue;
    const std::array<std::uint32_t, 3> v{std::uint32_t(i % n), std::uint32_t(i / n % n), std::uint32_t(i / n / n)};
    const Vec3 p{v[0] + 0.5, v[1] + 0.5, v[2] + 0.5};
    if (!counts(p)) continue;
    const auto angle = [&](Vec3 normal) { return std::acos(std::clamp(dot(normal, truth(p)), -1.0, 1.0)) * kDegrees; };
    const double a = angle(normals.neighbour_normal(v)), b = angle(normals.gradient_normal(v));
    sum.neighbour += a * a;
    sum.gradient += b * b;
    ++sum.voxels;
  }
}
Errors rms(Errors sum) {
  REQUIRE(sum.voxels > 0);
  return {std::sqrt(sum.neighbour / sum.voxels), std::sqrt(sum.gradient / sum.voxels), sum.voxels};
}
void print(const char* cell, const Errors& e) {
  std::printf("%-28s %9.2f %9.2f %8d\n", cell, e.neighbour, e.gradient, e.voxels);
}

}  // namespace

TEST_CASE("gradient normals have less than a third of the neighbour rule's error on spheres") {
  std::printf("RMS angle error of cell normals, degrees\n%-28s %9s %9s %8s\n", "cell", "26 rule", "gradient", "voxels");
  Rng rng(1);
  for (const std::uint32_t diameter : {8u, 16u, 32u, 64u}) {
    Errors sum;
    for (int k = 0; k < 6; ++k) {
      const std::uint32_t n = diameter + 8;
      const Vec3 c{n / 2 + rng.uniform(), n / 2 + rng.uniform(), n / 2 + rng.uniform()};
      const TileMap tile = cell_of(n, [&](Vec3 p) { return length(p - c) < diameter / 2.0; });
      add_errors(tile, [&](Vec3 p) { return normalize(p - c); }, [](Vec3) { return true; }, sum);
    }
    const Errors e = rms(sum);
    print(("sphere of " + std::to_string(diameter) + " voxels").c_str(), e);
    CHECK(e.gradient < e.neighbour / 3);
  }
}

TEST_CASE("gradient normals on planes and bricks") {
  Rng rng(2);
  Errors sum;
  for (int k = 0; k < 20; ++k) {
    const Vec3 n = normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)}), c{16, 16, 16};
    const TileMap tile = cell_of(32, [&](Vec3 p) { return dot(p - c, n) < 0; });
    // Away from the tile's border, where the cell ends too.
    const auto middle = [&](Vec3 p) { return std::max({std::abs(p.x - 16), std::abs(p.y - 16), std::abs(p.z - 16)}) < 10; };
    add_errors(tile, [&](Vec3) { return n; }, middle, sum);
  }
  const Errors plane = rms(sum);
  print("planes of any direction", plane);
  CHECK(plane.gradient < plane.neighbour / 3);

  const TileMap brick = cell_of(32, [](Vec3 p) { return p.x > 8 && p.x < 24 && p.y > 8 && p.y < 24 && p.z > 8 && p.z < 24; });
  Errors faces;
  const auto off = [](Vec3 p) { return Vec3{std::abs(p.x - 16), std::abs(p.y - 16), std::abs(p.z - 16)}; };
  const auto truth = [&](Vec3 p) {
    const Vec3 d = off(p);
    return d.x > 7 ? Vec3{p.x > 16 ? 1.0 : -1.0, 0, 0} : d.y > 7 ? Vec3{0, p.y > 16 ? 1.0 : -1.0, 0} : Vec3{0, 0, p.z > 16 ? 1.0 : -1.0};
  };
  const auto flat = [&](Vec3 p) {
    const Vec3 d = off(p);
    return int(d.x > 3) + int(d.y > 3) + int(d.z > 3) == 1;
  };
  add_errors(brick, truth, flat, faces);
  const Errors e = rms(faces);
  print("brick, 4 from its edges", e);
  CHECK(e.gradient < 1e-6);
}

TEST_CASE("a wall of one voxel has a normal all the same") {
  // Both rules see the same on either side: the source's mean is zero.
  const TileMap wall = cell_of(12, [](Vec3 p) { return p.z > 5 && p.z < 6; });
  const CellNormals normals(wall);
  CHECK(normals.neighbour_normal({6, 6, 5}) == Vec3{});
  CHECK(length(normals.gradient_normal({6, 6, 5})) == Approx(1));
}

TEST_CASE("normals continue across the tile's border, and the map holds them in order") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=3,resolution=16,seed=5"));
  const CellNormals normals(tile);
  const std::optional<NormalMap> one = make_normal_map(tile, 1), three = make_normal_map(tile, 3);
  REQUIRE(one.has_value());
  CHECK(*one == *three);
  const std::vector<std::uint8_t> boundary = boundary_voxels(tile);
  std::size_t k = 0;
  double worst = 0;
  for (std::uint64_t i = 0; i < boundary.size(); ++i) {
    if (!boundary[i]) continue;
    REQUIRE(k < one->normals.size());
    const Vec3 stored = to_vec3(decode_normal(one->normals[k++]));
    const Vec3 exact = normals.gradient_normal({std::uint32_t(i % 16), std::uint32_t(i / 16 % 16), std::uint32_t(i / 256)});
    worst = std::max(worst, std::acos(std::clamp(dot(stored, exact), -1.0, 1.0)) * kDegrees);
  }
  CHECK(k == one->normals.size());
  CHECK(worst < 1.0);
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  CHECK_FALSE(make_normal_map(tile, 2, &progress).has_value());
}

TEST_CASE("source 4.6: walls between two inside cells, and thin walls, spoil the mean of 26 directions") {
  // Two cells side by side, x < 8 and x >= 8, with empty space above and below: as one solid, its top is
  // flat.
  TileBuilder builder({16, 16, 16}, 2);
  std::uint64_t i = 0;
  for (std::uint32_t z = 0; z < 16; ++z)
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x, ++i)
        if (z >= 3 && z < 13) builder.set(i, builder.code(x < 8 ? 1 : 2, builder.image_index(0, 0, 0)));
  CellObject object;
  object.tile = builder.finish(1, nullptr);
  object.grid = {{0, 0, 0}, 1, {3, 3, 1}};
  object.membership = {MembershipRule::kCentre, {3, 3, 1}, 2, std::vector<std::uint32_t>(9, 1), {}};
  const CellNormals normals(object.tile);
  const auto caster = make_exact_caster(object);
  for (const double x : {23.5, 24.5}) {  // on both sides of the wall
    Hit hit;
    REQUIRE(caster->first_hit({{x, 24.5, 20}, {0, 0, -1}}, hit));
    CHECK(length(caster->shading_normal(hit) - Vec3{0, 0, 1}) < 1e-12);
    const Vec3 mean = normals.neighbour_normal({std::uint32_t(x) - 16, 8, 12});
    CHECK(std::acos(mean.z) * kDegrees > 40);
  }
  // A wall of one voxel: the mean is zero, but each side has its normal.
  CellObject wall;
  wall.tile = cell_of(16, [](Vec3 p) { return p.z > 7 && p.z < 8; });
  wall.grid = object.grid;
  wall.membership = {MembershipRule::kCentre, {3, 3, 1}, 1, std::vector<std::uint32_t>(9, 1), {}};
  const auto thin = make_exact_caster(wall);
  CHECK(CellNormals(wall.tile).neighbour_normal({8, 8, 7}) == Vec3{});
  for (const double side : {1.0, -1.0}) {
    Hit hit;
    REQUIRE(thin->first_hit({{24.5, 24.5, 7.5 + 5 * side}, {0, 0, -side}}, hit));
    CHECK(thin->shading_normal(hit) == Vec3{0, 0, side});
  }
}

TEST_CASE(
    "source 5.1: normals take two bytes, and only at boundaries, where the source has four floats a voxel") {
  // Table 5.1: the normal map takes 4 MB at 64 voxels, and 256 MB at 256.
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=64,seed=1"));
  const std::size_t by_source = 4 * sizeof(float) * tile.voxel_count();
  CHECK(by_source == 4u << 20);
  const std::optional<NormalMap> map = make_normal_map(tile);
  REQUIRE(map.has_value());
  const std::vector<std::uint8_t> boundary = boundary_voxels(tile);
  CHECK(map->normals.size() == std::size_t(std::count(boundary.begin(), boundary.end(), 1)));
  CHECK(map->normals.size() < tile.voxel_count() / 3);
  const std::size_t bytes = map->normals.size() * sizeof(map->normals[0]);
  CHECK(bytes < by_source / 25);
  // In a file it takes no more than that.
  CellObject object;
  object.tile = tile;
  object.grid = {{0, 0, 0}, 1, {1, 1, 1}};
  object.membership = {
      MembershipRule::kCentre, {1, 1, 1}, tile.cell_count, {std::uint32_t(Tag::kOutside)}, {}};
  const Result<std::vector<std::byte>> bare = encode_cell_object(object);
  object.normals = map;
  const Result<std::vector<std::byte>> whole = encode_cell_object(object);
  REQUIRE(bare.ok());
  REQUIRE(whole.ok());
  CHECK(whole->size() > bare->size());
  CHECK(whole->size() - bare->size() < bytes + 256);
  const TileMap large = *make_tile(*parse_recipe("voronoi:cells=8,resolution=256,seed=1"));
  CHECK(2 * count_boundary_voxels(large) < (256u << 20) / 100);
}
