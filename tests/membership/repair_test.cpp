#include "sdk/author/repair.h"

#include <atomic>
#include <cmath>

#include "sdk/author/cell_object.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

TriangleMesh bowl() {
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 16);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return mesh.vertices[t[0]].z + mesh.vertices[t[1]].z + mesh.vertices[t[2]].z > 0;
  });
  return mesh;
}

/// Two sheets that are bent, so that the winding number is above one half in no cell.
TriangleMesh sheet() { return {{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0}, {0, 1, 0.2}}, {{0, 1, 2}, {0, 2, 3}}}; }

/// In place of a wrap: the box of the mesh, larger by the offset.
Result<TriangleMesh> wrap_by_box(const TriangleMesh& mesh, double, double offset, const Progress*) {
  const Box3 box = bounding_box(mesh);
  const Vec3 room{offset, offset, offset};
  return make_box(box.min - room, box.max + room);
}

TileMap small_tile() { return *make_tile(*parse_recipe("voronoi:cells=8,resolution=8")); }

Result<CellObject> author(const TriangleMesh& mesh, const RepairOptions& repair, AuthorReport& report) {
  return author_cell_object(mesh, small_tile(), {.grid = {.tiles = 8}, .repair = repair}, &report);
}

}  // namespace

TEST_CASE("a closed mesh is not touched, whatever may be done") {
  const TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 12);
  for (const Repair repair :
       {Repair::kStrict, Repair::kOrient, Repair::kWinding, Repair::kWrap, Repair::kAuto}) {
    MeshDiagnosis found;
    const Result<RepairedMesh> out =
        repair_mesh(sphere, {.repair = repair, .wrapper = wrap_by_box}, nullptr, &found);
    REQUIRE(out.ok());
    CHECK_FALSE(out->mesh);
    CHECK(out->report.rung == RepairRung::kNone);
    CHECK(out->warnings.empty());
    CHECK(found.triangles == sphere.triangles.size());
    CHECK(found.closed());
  }
}

TEST_CASE("cracks are stitched before triangles are turned") {
  // Two halves of a sphere with a crack between them, one inside out: only once they are sewn can turning go
  // from one to the other.
  const TriangleMesh whole = make_sphere({0, 0, 0}, 1, 16);
  TriangleMesh mesh = whole, lower = bowl();
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return mesh.vertices[t[0]].z + mesh.vertices[t[1]].z + mesh.vertices[t[2]].z <= 0;
  });
  for (Vec3& v : lower.vertices) v.z -= 1e-6;
  flip(lower);
  append(mesh, lower);
  const Result<RepairedMesh> out = repair_mesh(mesh, {.repair = Repair::kOrient});
  REQUIRE(out.ok());
  CHECK(out->report.rung == RepairRung::kOrient);
  CHECK(out->report.stitched_edges > 0);
  CHECK(out->report.largest_move == Approx(1e-6));
  CHECK(out->report.turned_triangles == mesh.triangles.size() / 2);
  CHECK(signed_volume(*out->mesh) == Approx(signed_volume(whole)).epsilon(1e-5));
  REQUIRE(out->warnings.size() == 2);
  CHECK(out->warnings[0].id == "mesh-stitched");
  CHECK(out->warnings[1].id == "mesh-oriented");
  CHECK(repair_mesh(mesh, {.repair = Repair::kOrient, .stitch_tolerance = 1e-8}).error().id ==
        "mesh-not-closed");
}

TEST_CASE("a wrap replaces what stitching and turning leave open, if there is a wrapper") {
  CHECK(repair_mesh(bowl(), {.repair = Repair::kWrap}).error().code == ErrorCode::kUsage);
  const Result<RepairedMesh> out = repair_mesh(
      bowl(), {.repair = Repair::kWrap, .wrapper = wrap_by_box, .wrap_alpha = 0.5, .wrap_offset = 0.25});
  REQUIRE(out.ok());
  CHECK(out->report.rung == RepairRung::kWrap);
  CHECK(out->report.wrap_alpha == 0.5);
  CHECK(out->report.wrap_offset == 0.25);
  CHECK(out->report.wrap_distance > 0.25);
  CHECK(out->report.wrap_distance < 2);
  CHECK(out->mesh->triangles.size() == 12);
  CHECK(out->warnings.back().id == "mesh-wrapped");
  // Where none is given the lengths follow from the box.
  const Result<RepairedMesh> derived = repair_mesh(bowl(), {.repair = Repair::kWrap, .wrapper = wrap_by_box});
  REQUIRE(derived.ok());
  CHECK(derived->report.wrap_alpha == Approx(length(bounding_box(bowl()).extent()) / 20));
  CHECK(derived->report.wrap_offset == Approx(derived->report.wrap_alpha / 30));
}

TEST_CASE("auto takes the first rung that leaves a cell inside") {
  AuthorReport report;
  REQUIRE(author(bowl(), {.wrapper = wrap_by_box}, report).ok());
  CHECK(report.repair.rung == RepairRung::kWinding);
  CHECK(report.diagnosis.boundary_edges > 0);
  CHECK(author(sheet(), {}, report).error().id == "mesh-bounds-nothing");
  CHECK(report.diagnosis.boundary_edges == 4);
  CHECK(author(sheet(), {.repair = Repair::kWinding, .wrapper = wrap_by_box}, report).error().id ==
        "mesh-bounds-nothing");
  REQUIRE(author(sheet(), {.wrapper = wrap_by_box, .wrap_offset = 0.5}, report).ok());
  CHECK(report.repair.rung == RepairRung::kWrap);
  CHECK(report.repair.boundary_edges == 0);
  CHECK(report.mesh_volume == Approx(2 * 2 * 1.2));
  // A wrap that has no cell inside either is no solid.
  const MeshWrapper thin = [](const TriangleMesh&, double, double, const Progress*) {
    return Result<TriangleMesh>(make_box({0, 0, 0}, {1, 1, 1e-3}));
  };
  CHECK(author(sheet(), {.wrapper = thin}, report).error().id == "mesh-bounds-nothing");
}

TEST_CASE("an open mesh can be given a thickness instead") {
  AuthorReport report;
  const Result<CellObject> shell = author(bowl(), {.thickness = 0.5}, report);
  REQUIRE(shell.ok());
  CHECK(report.repair.rung == RepairRung::kThicken);
  CHECK(report.repair.thickness == 0.5);
  CHECK(report.repair.thickened_triangles == bowl().triangles.size());
  CHECK(report.repair.boundary_edges == 0);
  CHECK(report.mesh_volume == 0);
  CHECK(report.warnings.back().id == "mesh-thickened");
  // Of the shell between the radii of 0.75 and 1.25, half, and a round rim.
  const double between = 2.0 / 3 * 3.14159 * (1.25 * 1.25 * 1.25 - 0.75 * 0.75 * 0.75);
  CHECK(report.inside_volume > 0.5 * between);
  CHECK(report.inside_volume < between + 3.14159 * 0.0625 * 3.14159);
  REQUIRE(author(sheet(), {.thickness = 0.5}, report).ok());

  // Closed: it does nothing, and says so.
  REQUIRE(author(make_sphere({0, 0, 0}, 1, 12), {.thickness = 0.5}, report).ok());
  CHECK(report.repair.rung == RepairRung::kNone);
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].id == "option-unused");
  // Both sides of a sheet are closed and still enclose nothing.
  TriangleMesh leaf = sheet();
  leaf.triangles.insert(leaf.triangles.end(), {{2, 1, 0}, {3, 2, 0}});
  REQUIRE(author(leaf, {.thickness = 0.5}, report).ok());
  CHECK(report.repair.rung == RepairRung::kThicken);

  const AuthorOptions conservative{.repair = {.thickness = 0.5}, .rule = MembershipRule::kConservative};
  CHECK(author_cell_object(bowl(), small_tile(), conservative).error().code == ErrorCode::kUsage);
  CHECK(repair_mesh(bowl(), {.repair = Repair::kStrict, .thickness = 1}).error().id == "mesh-not-closed");
}

TEST_CASE("lengths that are none are refused, and repair can be cancelled") {
  for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
    CHECK(repair_mesh(bowl(), {.stitch_tolerance = bad}).error().code == ErrorCode::kUsage);
    CHECK(repair_mesh(bowl(), {.thickness = bad}).error().code == ErrorCode::kUsage);
    CHECK(repair_mesh(bowl(), {.wrap_alpha = bad}).error().code == ErrorCode::kUsage);
    CHECK(repair_mesh(bowl(), {.wrap_offset = bad}).error().code == ErrorCode::kUsage);
  }
  const std::atomic<bool> cancel = true;
  const Progress progress{{}, &cancel};
  CHECK(repair_mesh(bowl(), {}, &progress).error().code == ErrorCode::kCancelled);
}
