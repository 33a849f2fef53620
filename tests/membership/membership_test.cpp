#include "sdk/membership/membership.h"

#include <string>
#include <vector>

#include "converters/import/mesh_file.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

TileMap tile_of(const std::string& recipe) {
  Result<TileMap> tile = make_tile(*parse_recipe(recipe));
  REQUIRE(tile.ok());
  return std::move(*tile);
}

/// Tags of `mesh` (voxel units) against the definition, for a tile.
void check_against_definition(const TriangleMesh& mesh, const Index3& tiles, const TileMap& tile,
                              const std::vector<bool>& inside) {
  for (const unsigned threads : {1u, 3u}) {
    MembershipReport report;
    const Result<MembershipMap> map = compute_membership(mesh, tiles, tile, {.threads = threads}, &report);
    REQUIRE(map.ok());
    REQUIRE(map->entries.size() == std::size_t{tiles[0]} * tiles[1] * tiles[2]);
    CHECK(wrong_tags(*map, tags_by_definition(inside, tiles, tile)) == 0);
    CHECK(report.inside_voxels == std::uint64_t(std::count(inside.begin(), inside.end(), true)));
    const InstanceCounts n = count_instances(*map);
    CHECK(n.inside + n.outside + n.intersected == map->entries.size() * tile.cell_count);
  }
}

/// Three tiles of a resolution: many cells, empty space, and a cell that meets its own copies.
std::vector<std::string> recipes(std::uint32_t resolution) {
  const std::string r = ",resolution=" + std::to_string(resolution);
  return {"voronoi:cells=8" + r, "spheres:cells=12,seed=4" + r, "voronoi:cells=1,seed=7" + r};
}

void check_mesh(const TriangleMesh& mesh, std::uint32_t tiles, std::uint32_t resolution,
                const std::optional<Box3>& box = std::nullopt) {
  const Result<GridLayout> grid =
      lay_grid(bounding_box(mesh), {resolution, resolution, resolution}, {.tiles = tiles, .box = box});
  REQUIRE(grid.ok());
  const TriangleMesh m = in_voxels(mesh, *grid);
  std::vector<bool> inside;
  for (const std::string& recipe : recipes(resolution)) {
    INFO(recipe);
    const TileMap tile = tile_of(recipe);
    if (inside.empty()) inside = inside_by_definition(m, voxels_of(grid->tiles, tile));
    check_against_definition(m, grid->tiles, tile, inside);
  }
}

}  // namespace

TEST_CASE("every tag of generated meshes equals the definition, voxel by voxel") {
  SECTION("sphere") { check_mesh(make_sphere({0.3, 0.2, 0.1}, 1.7, 40), 8, 16); }
  SECTION("torus") { check_mesh(make_torus({0, 0, 0}, 3, 1, 60, 30), 8, 23); }
  SECTION("cube with its faces on voxel faces, and at voxel centres") {
    const TileMap voronoi = tile_of("voronoi:cells=8,resolution=16");
    for (const double shift : {0.0, 0.5}) {
      const TriangleMesh cube =
          make_box(Vec3{8, 8, 8} + Vec3{1, 1, 1} * shift, Vec3{56, 56, 56} + Vec3{1, 1, 1} * shift);
      const auto inside = inside_by_definition(cube, {64, 64, 64});
      // Half-open: a cube of 48 voxels holds 48³ centres, wherever its faces are.
      CHECK(std::count(inside.begin(), inside.end(), true) == 48 * 48 * 48);
      for (const std::string& recipe : recipes(16))
        check_against_definition(cube, {4, 4, 4}, tile_of(recipe), inside);
    }
  }
  SECTION("a grid that cuts the mesh off, so that many instances leave it") {
    check_mesh(make_sphere({0, 0, 0}, 2, 30), 6, 16, Box3{{-1.5, -1, -1.2}, {1, 2.5, 1.6}});
  }
  SECTION("far from the origin") {
    check_mesh(make_sphere({1e6, 1e6, -1e6}, 1.7, 40), 6, 16);
    check_mesh(make_box({1e6, 1e6, 1e6}, {1e6 + 1, 1e6 + 2, 1e6 + 3}), 6, 16);
  }
  SECTION("very small, very large") {
    check_mesh(make_sphere({1, 2, 3}, 1e-6, 24), 6, 16);
    check_mesh(make_torus({0, 0, 0}, 3e12, 1e12, 30, 20), 6, 16);
  }
  SECTION("slender, flat, with a sharp point") {
    TriangleMesh flat = make_sphere({0, 0, 0}, 1, 30);
    for (Vec3& v : flat.vertices) v.z *= 1e-3;
    check_mesh(flat, 6, 16);
    check_mesh(make_torus({0, 0, 0}, 3, 0.02, 100, 6), 6, 16);
    check_mesh(make_tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 20}), 6, 16);
  }
  SECTION("tiles that are not cubes") {
    const TileMap tile = tile_of("voronoi:cells=9,resolution=20x7x12");
    const TriangleMesh mesh = make_torus({40, 35, 36}, 24, 9, 50, 30);
    check_against_definition(mesh, {4, 10, 6}, tile, inside_by_definition(mesh, {80, 70, 72}));
  }
}

TEST_CASE("every tag of real meshes equals the definition, voxel by voxel", "[slow]") {
  for (const char* name : {"rocker-arm.obj", "fandisk.off", "knot1.off", "armadillo.obj", "spot.obj",
                           "lucy.ply", "knot_orig_metro.ply"}) {
    const auto path = find_data(std::string("meshes/") + name);
    if (!path) {
      WARN(name << " is not here; skipped");
      continue;
    }
    INFO(name);
    const Result<TriangleMesh> mesh = read_mesh_file(*path);
    REQUIRE(mesh.ok());
    check_mesh(*mesh, 8, 25);
  }
}

TEST_CASE("winding numbers: overlap, cavity, inside out") {
  const TileMap tile = tile_of("voronoi:cells=8,resolution=16");
  const Index3 tiles{4, 4, 4}, voxels{64, 64, 64};
  TriangleMesh mesh = make_box({4, 4, 4}, {60, 60, 60});
  SECTION("a nested shell of the same orientation changes nothing") {
    const auto before = inside_by_definition(mesh, voxels);
    append(mesh, make_sphere({32, 32, 32}, 20, 20));
    const auto after = inside_by_definition(mesh, voxels);
    CHECK(before == after);
    check_against_definition(mesh, tiles, tile, after);
  }
  SECTION("one of the other orientation is a cavity") {
    TriangleMesh cavity = make_sphere({32, 32, 32}, 20, 20);
    flip(cavity);
    append(mesh, cavity);
    const auto inside = inside_by_definition(mesh, voxels);
    CHECK_FALSE(inside[32 + 64 * (32 + 64 * 32)]);
    check_against_definition(mesh, tiles, tile, inside);
  }
  SECTION("overlapping parts are united") {
    append(mesh, make_box({30.5, 30.25, 30}, {63, 63, 63}));
    check_against_definition(mesh, tiles, tile, inside_by_definition(mesh, voxels));
  }
  SECTION("a mesh turned inside out is solid") {
    flip(mesh);
    const auto inside = inside_by_definition(mesh, voxels);
    CHECK(inside[32 + 64 * (32 + 64 * 32)]);
    check_against_definition(mesh, tiles, tile, inside);
  }
}

TEST_CASE("two solids that share a face partition their voxels") {
  Rng rng(11);
  const Index3 voxels{24, 24, 24};
  for (int k = 0; k < 40; ++k) {
    // Corners at multiples of half a voxel: many centres lie on faces, edges and corners.
    const auto half = [&](std::uint32_t low, std::uint32_t high) {
      return (low + rng.below(high - low)) * 0.5;
    };
    const Vec3 a{half(0, 16), half(0, 16), half(0, 16)}, b{half(30, 48), half(0, 20), half(0, 20)},
        c{half(0, 20), half(30, 48), half(0, 20)}, d{half(0, 20), half(0, 20), half(30, 48)},
        e{half(30, 48), half(30, 48), half(30, 48)};
    const TriangleMesh one = make_tetrahedron(a, b, c, d), other = make_tetrahedron(b, c, d, e);
    TriangleMesh both = one;
    append(both, other);
    const TileMap tile = tile_of("voronoi:cells=2,resolution=12");
    MembershipReport r1, r2, r12;
    REQUIRE(compute_membership(one, {2, 2, 2}, tile, {}, &r1).ok());
    REQUIRE(compute_membership(other, {2, 2, 2}, tile, {}, &r2).ok());
    REQUIRE(compute_membership(both, {2, 2, 2}, tile, {}, &r12).ok());
    // e may lie on the same side as a; then they overlap and the union is smaller.
    const auto i1 = inside_by_definition(one, voxels), i2 = inside_by_definition(other, voxels);
    std::uint64_t common = 0;
    for (std::size_t i = 0; i < i1.size(); ++i) common += i1[i] && i2[i];
    CHECK(r12.inside_voxels == r1.inside_voxels + r2.inside_voxels - common);
    const double side_a = dot(cross(c - b, d - b), a - b), side_e = dot(cross(c - b, d - b), e - b);
    if (side_a * side_e < 0) CHECK(common == 0);
  }
}

TEST_CASE("adversarial small meshes equal the definition") {
  Rng rng(12);
  const TileMap tile = tile_of("voronoi:cells=3,resolution=8,seed=2");
  const Index3 tiles{2, 2, 2}, voxels{16, 16, 16};
  for (std::size_t k = 0; k < repetitions(3000); ++k) {
    TriangleMesh mesh;
    const std::uint32_t parts = 1 + rng.below(3);
    for (std::uint32_t p = 0; p < parts; ++p) {
      const auto coordinate = [&]() {
        switch (rng.below(5)) {
          case 0:
            return double(rng.below(17));  // on a voxel face
          case 1:
            return double(rng.below(16)) + 0.5;  // at a voxel centre
          case 2:
            return double(rng.below(16)) + 0.5 + 0x1p-45;  // just beyond one
          case 3:
            return rng.uniform(0, 16);
          default:
            return rng.uniform(-4, 20);  // beyond the grid too
        }
      };
      const auto point = [&]() { return Vec3{coordinate(), coordinate(), coordinate()}; };
      if (rng.below(3) == 0) {
        const Vec3 a = point(), b = point();
        append(mesh, make_box(min(a, b), max(a, b)));
      } else {
        const Vec3 a = point(), b = point();
        // A sliver: two corners nearly together.
        const Vec3 c = rng.below(4) == 0 ? a + Vec3{0x1p-40, rng.uniform(-1e-9, 1e-9), 0} : point();
        append(mesh, make_tetrahedron(a, b, c, point()));
      }
      if (rng.below(4) == 0) flip(mesh);
    }
    const auto inside = inside_by_definition(mesh, voxels);
    MembershipReport report;
    const Result<MembershipMap> map = compute_membership(mesh, tiles, tile, {.threads = 1}, &report);
    REQUIRE(map.ok());
    REQUIRE(report.inside_voxels == std::uint64_t(std::count(inside.begin(), inside.end(), true)));
    REQUIRE(wrong_tags(*map, tags_by_definition(inside, tiles, tile)) == 0);
  }
}

TEST_CASE("by rule conservative, whatever the surface touches is intersected") {
  const auto check = [](const TriangleMesh& mesh, const Index3& tiles,
                        const std::vector<std::string>& tile_recipes) {
    std::vector<bool> inside, touched;
    for (const std::string& recipe : tile_recipes) {
      const TileMap tile = tile_of(recipe);
      if (inside.empty()) {
        inside = inside_by_definition(mesh, voxels_of(tiles, tile));
        touched = touched_by_definition(mesh, voxels_of(tiles, tile));
      }
      const Result<MembershipMap> map =
          compute_membership(mesh, tiles, tile, {.rule = MembershipRule::kConservative, .threads = 2});
      REQUIRE(map.ok());
      CHECK(map->rule == MembershipRule::kConservative);
      REQUIRE(wrong_tags(*map, tags_by_definition(inside, tiles, tile, touched)) == 0);
    }
  };
  SECTION("a cube with its faces on voxel faces touches the voxels on both sides") {
    check(make_box({4, 4, 4}, {28, 28, 28}), {4, 4, 4}, recipes(8));
    check(make_box({8, 8, 8}, {24, 24, 24}), {4, 4, 4}, recipes(8));  // on the tiles' faces too
    check(make_box({0, 0, 0}, {32, 32, 32}), {4, 4, 4}, recipes(8));
  }
  SECTION("round meshes, several tiles") {
    check(make_sphere({20, 21, 22}, 16, 12), {4, 4, 4}, recipes(11));
    check(make_torus({22, 22, 22}, 14, 6, 20, 12), {4, 4, 4}, recipes(11));
    check(make_sphere({20, 21, 22}, 16, 12), {3, 6, 3}, {"voronoi:cells=300,resolution=14x7x16"});
  }
  SECTION("a real mesh") {
    const auto path = find_data("meshes/knot1.off");
    if (!path) {
      WARN("knot1.off is not here; skipped");
      return;
    }
    const TriangleMesh mesh = *read_mesh_file(*path);
    const Result<GridLayout> grid = lay_grid(bounding_box(mesh), {9, 9, 9}, {.tiles = 5});
    check(in_voxels(mesh, *grid), grid->tiles, recipes(9));
  }
  SECTION("adversarial small meshes") {
    Rng rng(13);
    for (std::size_t k = 0; k < repetitions(150); ++k) {
      const auto coordinate = [&]() {
        switch (rng.below(4)) {
          case 0:
            return double(rng.below(9));
          case 1:
            return double(rng.below(8)) + (rng.below(2) ? 0x1p-45 : -0x1p-45);
          case 2:
            return rng.uniform(0, 8);
          default:
            return rng.uniform(-2, 10);
        }
      };
      const auto point = [&]() { return Vec3{coordinate(), coordinate(), coordinate()}; };
      const Vec3 a = point(), b = point();
      const TriangleMesh mesh =
          rng.below(2) ? make_tetrahedron(a, b, point(), point()) : make_box(min(a, b), max(a, b));
      check(mesh, {2, 2, 2}, {"voronoi:cells=4,resolution=4,seed=2"});
    }
  }
}

TEST_CASE("limits and cancel are told") {
  const TileMap tile = tile_of("voronoi:cells=8,resolution=16");
  const TriangleMesh mesh = make_sphere({32, 32, 32}, 30, 20);
  CHECK(compute_membership(mesh, {4, 4, 4}, tile, {.max_bytes = 100}).error().code == ErrorCode::kLimit);
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  CHECK(compute_membership(mesh, {4, 4, 4}, tile, {}, nullptr, &progress).error().code ==
        ErrorCode::kCancelled);
}
