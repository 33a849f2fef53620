#include "sdk/measure/surface_distance.h"

#include <atomic>
#include <cmath>

#include "converters/import/mesh_file.h"
#include "sdk/author/cell_object.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/objects.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

CellObject one_block() {
  return make_blocks({3, 3, 3}, 4, [](auto x, auto y, auto z) { return x == 1 && y == 1 && z == 1; });
}

SurfaceDistance measure(const CellObject& object, const TriangleMesh& mesh,
                        const SurfaceDistanceOptions& options = {}) {
  const Result<SurfaceDistance> result = measure_surface_distance(object, mesh, options);
  INFO((result ? std::string() : result.error().message));
  REQUIRE(result.ok());
  return *result;
}

void check_equal(const DistanceFigures& a, const DistanceFigures& b, double scale = 1) {
  CHECK(a.max * scale == b.max);
  CHECK(a.mean * scale == b.mean);
  CHECK(a.rms * scale == b.rms);
  CHECK(a.samples == b.samples);
}

}  // namespace

TEST_CASE("a cube in a cube has the distances that are found by hand") {
  // The asset is [4, 8]³, the mesh [3, 9]³. Every point of the asset's faces is 1 from the mesh. A face of
  // the mesh is 6 × 6: 4 × 4 of it are 1 from the asset, strips of 4 × 1 are √(1 + s²), corners of 1 × 1 are
  // √(1 + s² + t²).
  const SurfaceDistance d = measure(one_block(), make_box({3, 3, 3}, {9, 9, 9}));
  CHECK(d.seed == 1);
  CHECK(d.diagonal == Approx(6 * std::sqrt(3)));
  CHECK(d.percent(d.diagonal / 4) == Approx(25));
  CHECK(d.asset_to_mesh.samples == 100000);
  CHECK(d.asset_to_mesh.max == Approx(1).epsilon(1e-12));
  CHECK(d.asset_to_mesh.mean == Approx(1).epsilon(1e-12));
  CHECK(d.asset_to_mesh.rms == Approx(1).epsilon(1e-12));
  CHECK(d.mesh_to_asset.samples == 100000);
  CHECK(d.mesh_to_asset.max <= std::sqrt(3));
  CHECK(d.mesh_to_asset.max > std::sqrt(3) - 0.02);
  CHECK(d.mesh_to_asset.rms == Approx(std::sqrt((16 + 16 * (4 / 3.0) + 4 * (5 / 3.0)) / 36)).epsilon(2e-3));
  double corner = 0;
  for (int i = 0; i < 100; ++i)
    for (int k = 0; k < 100; ++k) corner += std::hypot(1, (i + 0.5) / 100, (k + 0.5) / 100) / 10000;
  const double strip = (std::sqrt(2) + std::asinh(1)) / 2;
  CHECK(d.mesh_to_asset.mean == Approx((16 + 16 * strip + 4 * corner) / 36).epsilon(2e-3));
}

TEST_CASE("lines find faces by their area, and each place of a face alike") {
  // The mesh is a plane far above a slab, so a distance tells the height of its sample.
  const CellObject slab = make_blocks({5, 1, 5}, 4, [](auto...) { return true; });
  const double far = 1000, size = 1e5;
  TriangleMesh plane{{{-size, far, -size}, {size, far, -size}, {0, far, size}}, {{0, 1, 2}}};
  const SurfaceDistance d = measure(slab, plane, {.samples = 200000});
  // Top (4) and bottom (0) have 400 each, the sides 4 · 80 and a mean of 2 and a mean square of 16 / 3.
  CHECK(d.asset_to_mesh.mean == Approx(far - 2).epsilon(2e-5));
  const double variance = std::pow(d.asset_to_mesh.rms, 2) - std::pow(d.asset_to_mesh.mean, 2);
  CHECK(variance == Approx((400 * 16 + 320 * (16 / 3.0)) / 1120 - 4).epsilon(1e-2));
}

TEST_CASE("walls that cannot be seen do not count, and what is inside is at no distance") {
  const auto not_centre = [](auto x, auto y, auto z) { return !(x == 2 && y == 2 && z == 2); };
  const CellObject hollow = make_blocks({5, 5, 5}, 4, not_centre);
  const SurfaceDistance outside = measure(hollow, make_box({0, 0, 0}, {20, 20, 20}), {.samples = 5000});
  CHECK(outside.asset_to_mesh.max < 1e-12);
  CHECK(outside.mesh_to_asset.max == 0);
  const SurfaceDistance within = measure(hollow, make_box({2, 2, 2}, {18, 18, 18}), {.samples = 5000});
  CHECK(within.asset_to_mesh.max > 2.5);
  CHECK(within.mesh_to_asset.max == 0);
  // In the hole the asset is at a distance again: up to 2 from a face.
  const SurfaceDistance hole = measure(hollow, make_box({9, 9, 9}, {11, 11, 11}), {.samples = 5000});
  CHECK(hole.mesh_to_asset.max == Approx(1).epsilon(1e-9));
}

TEST_CASE("figures depend on the seed and on nothing else") {
  const CellObject object = one_block();
  const TriangleMesh mesh = make_torus({6, 6, 6}, 3, 1, 30, 20);
  const SurfaceDistance one = measure(object, mesh, {.samples = 10001, .seed = 7, .threads = 1});
  const SurfaceDistance many = measure(object, mesh, {.samples = 10001, .seed = 7, .threads = 5});
  CHECK(one.asset_to_mesh.samples == 10001);
  check_equal(one.asset_to_mesh, many.asset_to_mesh);
  check_equal(one.mesh_to_asset, many.mesh_to_asset);
  const SurfaceDistance other = measure(object, mesh, {.samples = 10001, .seed = 8});
  CHECK(other.asset_to_mesh.mean != one.asset_to_mesh.mean);
  CHECK(other.mesh_to_asset.mean != one.mesh_to_asset.mean);
  CHECK(other.asset_to_mesh.mean == Approx(one.asset_to_mesh.mean).epsilon(0.03));
  CHECK(other.mesh_to_asset.mean == Approx(one.mesh_to_asset.mean).epsilon(0.03));
}

TEST_CASE("objects of any size are measured alike") {
  const TriangleMesh mesh = make_torus({6, 6, 6}, 3, 1, 30, 20);
  const SurfaceDistance plain = measure(one_block(), mesh, {.samples = 3000});
  for (const int exponent : {-600, -30, 40, 600}) {
    const double scale = std::ldexp(1.0, exponent);
    CellObject object = one_block();
    object.grid.voxel_edge = scale;
    TriangleMesh scaled = mesh;
    for (Vec3& v : scaled.vertices) v = v * scale;
    const SurfaceDistance d = measure(object, scaled, {.samples = 3000});
    check_equal(plain.asset_to_mesh, d.asset_to_mesh, scale);
    check_equal(plain.mesh_to_asset, d.mesh_to_asset, scale);
    CHECK(plain.diagonal * scale == d.diagonal);
  }
}

TEST_CASE("what cannot be measured is refused with its reason") {
  const TriangleMesh mesh = make_box({3, 3, 3}, {9, 9, 9});
  const auto error = [](const CellObject& object, const TriangleMesh& of,
                        const Progress* progress = nullptr) {
    const Result<SurfaceDistance> result = measure_surface_distance(object, of, {.samples = 100}, progress);
    REQUIRE_FALSE(result.ok());
    return result.error();
  };
  const auto has = [](const Error& e, const char* text) { return e.message.find(text) != std::string::npos; };
  for (const TriangleMesh& bad :
       {TriangleMesh{}, TriangleMesh{{{1, 2, 3}}, {{0, 0, 0}}},
        TriangleMesh{{{0, 0, 0}, {1, 1, 1}}, {{0, 1, 0}}}, make_box({-1e30, 0, 0}, {1, 1, 1})})
    CHECK(error(one_block(), bad).code == ErrorCode::kInvalidInput);
  CHECK(has(error(one_block(), {}), "no triangles"));
  CHECK(has(error(one_block(), make_box({0, 0, 0}, {1e30, 1, 1})), "beyond"));
  const Error empty = error(make_blocks({2, 2, 2}, 4, [](auto...) { return false; }), mesh);
  CHECK(empty.code == ErrorCode::kInvalidInput);
  CHECK(has(empty, "no cell is inside"));
  // A speck in a grid too large to hit it.
  const Error speck =
      error(make_blocks({1000000, 1, 1}, 4, [](auto x, auto, auto) { return x == 77; }), mesh);
  CHECK(speck.code == ErrorCode::kInvalidInput);
  CHECK(has(speck, "random lines"));
  const std::atomic<bool> stop{true};
  const Progress progress{{}, &stop};
  CHECK(error(one_block(), mesh, &progress).code == ErrorCode::kCancelled);
}

TEST_CASE("distances fall as tiles get smaller, in both directions and by both rules", "[slow]") {
  std::vector<std::pair<std::string, TriangleMesh>> meshes = {
      {"sphere", make_sphere({1, 2, 3}, 1, 24)}, {"torus", make_torus({0, 0, 0}, 2, 0.8, 40, 20)}};
  if (const auto path = find_data("meshes/rocker-arm.obj")) {
    Result<TriangleMesh> mesh = read_mesh_file(*path);
    REQUIRE(mesh.ok());
    meshes.emplace_back("rocker arm", std::move(*mesh));
  }
  const Result<TileMap> tile = make_tile(*parse_recipe("voronoi:cells=12,resolution=6,seed=1"));
  REQUIRE(tile.ok());
  for (const auto& [name, mesh] : meshes)
    for (const MembershipRule rule : {MembershipRule::kCentre, MembershipRule::kConservative}) {
      SurfaceDistance last;
      for (const std::uint32_t tiles : {8u, 16u, 32u, 64u}) {
        INFO(name << ", rule " << int(rule) << ", " << tiles << " tiles");
        AuthorOptions options;
        options.rule = rule;
        options.grid.tiles = tiles;
        const Result<CellObject> object = author_cell_object(mesh, *tile, options);
        REQUIRE(object.ok());
        const SurfaceDistance d = measure(*object, mesh, {.samples = 5000});
        if (tiles > 8) {
          CHECK(d.asset_to_mesh.mean < last.asset_to_mesh.mean);
          CHECK(d.asset_to_mesh.rms < last.asset_to_mesh.rms);
          CHECK(d.mesh_to_asset.mean < last.mesh_to_asset.mean);
          CHECK(d.mesh_to_asset.rms < last.mesh_to_asset.rms);
        }
        last = d;
      }
      CHECK(last.percent(last.asset_to_mesh.rms) < 0.6);
      CHECK(last.percent(last.mesh_to_asset.rms) < 0.6);
    }
}
