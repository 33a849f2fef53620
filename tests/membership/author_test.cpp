#include <cmath>

#include "sdk/author/cell_object.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

TEST_CASE("the grid leaves a voxel of room along the longest side and covers the rest") {
  const Box3 box{{1, 2, 3}, {5, 4, 3.5}};
  const Result<GridLayout> grid = lay_grid(box, {16, 16, 16}, {.tiles = 4});
  REQUIRE(grid.ok());
  const double tile_edge = 4.0 * 64 / 62 / 4;
  CHECK(grid->voxel_edge * 16 == Approx(tile_edge).epsilon(1e-14));
  CHECK(grid->tiles == Index3{4, 2, 1});
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = grid->tiles[a] * 16 * grid->voxel_edge;
    CHECK(grid->box_min[a] + size / 2 == Approx((box.min[a] + box.max[a]) / 2));
    CHECK(grid->box_min[a] <= box.min[a]);
    CHECK(grid->box_min[a] + size >= box.max[a]);
  }
  CHECK(box.min.x - grid->box_min[0] == Approx(grid->voxel_edge));
}

TEST_CASE("tile size and box replace what is taken from the mesh") {
  const Box3 box{{0, 0, 0}, {1, 0.5, 0.25}};
  Result<GridLayout> grid = lay_grid(box, {8, 8, 8}, {.tile_size = 0.125});
  REQUIRE(grid.ok());
  CHECK(grid->tiles == Index3{8, 4, 2});
  CHECK(grid->voxel_edge == 0.125 / 8);
  grid = lay_grid(box, {8, 8, 8}, {.tiles = 4, .box = Box3{{-1, -1, -1}, {1, 1, 0}}});
  REQUIRE(grid.ok());
  CHECK(grid->tiles == Index3{4, 4, 2});
  CHECK(grid->box_min == std::array<double, 3>{-1, -1, -1});
  CHECK(grid->voxel_edge == 0.0625);
}

TEST_CASE("a grid that cannot be is refused for the right reason") {
  const Box3 unit{{0, 0, 0}, {1, 1, 1}};
  const auto code = [](const Box3& box, const GridOptions& o) {
    return lay_grid(box, {16, 16, 16}, o).error().code;
  };
  CHECK(code(unit, {.tiles = 0}) == ErrorCode::kUsage);
  CHECK(code(unit, {.tile_size = -1}) == ErrorCode::kUsage);
  CHECK(code(unit, {.tile_size = std::nan("")}) == ErrorCode::kUsage);
  CHECK(code(unit, {.box = Box3{{0, 0, 0}, {-1, 1, 1}}}) == ErrorCode::kUsage);
  CHECK(code(unit, {.tiles = 1000000}) == ErrorCode::kLimit);
  CHECK(code(unit, {.tile_size = 1e-9}) == ErrorCode::kLimit);
  CHECK(code({{0, 0, 0}, {1, 1e-12, 1e-12}}, {.tiles = 4000000000}) == ErrorCode::kLimit);
  CHECK(code({{2, 2, 2}, {2, 2, 2}}, {}) == ErrorCode::kInvalidInput);
  CHECK(code({{-1e308, 0, 0}, {1e308, 1, 1}}, {}) == ErrorCode::kInvalidInput);
  CHECK(code({{1e9, 1e9, 1e9}, {1e9 + 1e-6, 1e9 + 1e-6, 1e9 + 1e-6}}, {.tiles = 100}) ==
        ErrorCode::kInvalidInput);
}

TEST_CASE("scale and place do not change the tags") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  const TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 20);
  const Result<CellObject> plain = author_cell_object(sphere, tile, {.grid = {.tiles = 8}});
  REQUIRE(plain.ok());
  for (const double scale : {0x1p-100, 0x1p-20, 0x1p20, 0x1p100}) {
    TriangleMesh scaled = sphere;
    for (Vec3& v : scaled.vertices) v = v * scale;
    const Result<CellObject> object = author_cell_object(scaled, tile, {.grid = {.tiles = 8}});
    REQUIRE(object.ok());
    CHECK(object->membership == plain->membership);
  }
}

TEST_CASE("the inside volume approaches the mesh's from below") {
  const TriangleMesh torus = make_torus({0, 0, 0}, 3, 1, 60, 30);
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  double before = 0;
  for (const std::uint32_t tiles : {8u, 16u, 32u}) {
    AuthorReport report;
    REQUIRE(author_cell_object(torus, tile, {.grid = {.tiles = tiles}}, &report).ok());
    CHECK(report.inside_volume > before);
    CHECK(report.inside_volume < report.mesh_volume);
    CHECK(report.warnings.empty());
    before = report.inside_volume;
  }
}

TEST_CASE("a mesh that bounds nothing is refused with its diagnosis") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  const auto error = [&](const TriangleMesh& mesh) {
    const Result<CellObject> object = author_cell_object(mesh, tile, {.repair = {Repair::kStrict}});
    REQUIRE_FALSE(object.ok());
    CHECK(object.error().code == ErrorCode::kInvalidInput);
    // What no repair makes a solid of is refused by all of them.
    CHECK_FALSE(author_cell_object(mesh, tile, {.repair = {Repair::kOrient}}).ok());
    return object.error().message;
  };
  TriangleMesh open = make_box({0, 0, 0}, {1, 1, 1});
  open.triangles.resize(11);
  CHECK(error(open).find("3 boundary edges") != std::string::npos);
  CHECK(error({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}).find("3 boundary edges") !=
        std::string::npos);
  CHECK(error({}).find("no triangles") != std::string::npos);
  CHECK(error({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}}).find("flat") != std::string::npos);
  CHECK(error({{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}}}).find("degenerate") != std::string::npos);
}

TEST_CASE("what is odd but can be done is done with a warning") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  AuthorReport report;
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  flip(box);
  REQUIRE(author_cell_object(box, tile, {}, &report).ok());
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].id == "mesh-inside-out");
  REQUIRE(author_cell_object(make_sphere({0, 0, 0}, 1, 8), tile, {.grid = {.tiles = 1}}, &report).ok());
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].id == "no-inside-cells");
}

TEST_CASE("a mesh is repaired as far as it needs and the options allow, and the report says how") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=8"));
  const TriangleMesh sound = make_sphere({0, 0, 0}, 1, 24);
  const auto author = [&](const TriangleMesh& mesh, Repair repair, AuthorReport& report) {
    return author_cell_object(mesh, tile, {.grid = {.tiles = 8}, .repair = {repair}}, &report);
  };
  AuthorReport report;
  const Result<CellObject> whole = author(sound, Repair::kWinding, report);
  REQUIRE(whole.ok());
  CHECK(report.repair.rung == RepairRung::kNone);
  CHECK(report.warnings.empty());

  TriangleMesh turned = sound;
  for (std::size_t t = 0; t < turned.triangles.size(); t += 7)
    std::swap(turned.triangles[t][0], turned.triangles[t][1]);
  turned.triangles.push_back(turned.triangles[1]);
  CHECK(author(turned, Repair::kStrict, report).error().id == "mesh-not-closed");
  for (const Repair repair : {Repair::kOrient, Repair::kWinding}) {
    const Result<CellObject> object = author(turned, repair, report);
    REQUIRE(object.ok());
    CHECK(report.repair.rung == RepairRung::kOrient);
    CHECK(report.repair.turned_triangles == (sound.triangles.size() + 6) / 7);
    CHECK(report.repair.dropped_triangles == 1);
    CHECK(object->membership == whole->membership);
  }

  TriangleMesh open = turned;
  open.triangles.erase(open.triangles.begin() + 200, open.triangles.begin() + 204);
  CHECK(author(open, Repair::kOrient, report).error().id == "mesh-not-closed");
  const Result<CellObject> object = author(open, Repair::kWinding, report);
  REQUIRE(object.ok());
  CHECK(report.repair.rung == RepairRung::kWinding);
  CHECK(report.repair.boundary_edges > 0);
  CHECK(report.repair.unsure_voxels > 0);
  CHECK(report.mesh_volume == 0);
  CHECK(report.inside_volume == Approx(inside_volume(*whole)).epsilon(0.01));

  // A sheet, bent so that it has a box: its winding number is below one half everywhere.
  const TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0}, {0, 1, 0.2}}, {{0, 1, 2}, {0, 2, 3}}};
  CHECK(author(sheet, Repair::kWinding, report).error().id == "mesh-bounds-nothing");
}
