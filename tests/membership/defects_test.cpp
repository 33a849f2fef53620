#include <string>

#include "converters/import/mesh_file.h"
#include "sdk/membership/diagnose.h"
#include "sdk/membership/orient.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// What is known of a file of the optional test data, counted by others too. They count as inside another
/// what we do not: components that cross it. And an inside-out component in another is a cavity here.
struct Known {
  const char* file;
  std::uint64_t boundary, non_manifold, misoriented, fans, duplicates, opposite, zero_area, unreferenced,
      self_intersections, components, inside_out, nested;
};

constexpr Known kKnown[] = {
    {"defects/40509.stl", 16, 0, 9, 0, 0, 0, 0, 0, 1351, 10, 0, 0},
    {"defects/blobby-shuffled.off", 0, 0, 3069, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/chair.off", 1, 1029, 0, 6, 1, 675, 226, 0, 5634, 5, 0, 0},
    {"defects/cube-minimal-degenerated.obj", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/cube_40k.obj", 1340, 55580, 1560, 0, 0, 8000, 0, 0, 0, 1, 0, 0},
    {"defects/degtri_sliding.off", 6, 0, 0, 0, 0, 0, 4, 0, 3, 1, 0, 0},
    // Of its opposite duplicates others count 1052, the sets of triangles in which there are any.
    {"defects/dragon_vrip_res3.ply", 0, 2094, 0, 5, 202, 1067, 0, 16, 115, 2, 0, 1},
    {"defects/elephant-with-holes.off", 1353, 0, 0, 65, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/featuretype.STL", 576, 0, 0, 0, 0, 0, 0, 0, 1216, 1, 0, 0},
    {"defects/moebius.obj", 112, 0, 4, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/nancolor.obj", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/nearby-bad.stl", 4, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/normal-directions-bad.stl", 0, 0, 3, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/not_convex.obj", 0, 12, 0, 0, 0, 0, 0, 0, 156, 1, 0, 0},
    {"defects/openscad-nonmanifold-crash.obj", 0, 18, 0, 34, 1, 2, 1, 0, 7542, 2, 0, 0},
    {"defects/rot_seven_cubes.obj", 0, 0, 0, 0, 0, 0, 0, 0, 1568, 8, 8, 0},
    {"defects/stratocaster.ply", 0, 0, 0, 0, 0, 0, 0, 0, 8166, 94, 0, 0},
    {"defects/suzanne.obj", 42, 1, 0, 2, 0, 1, 0, 0, 90, 3, 0, 0},
    {"defects/teapot.obj", 160, 0, 0, 1, 0, 0, 0, 0, 161, 4, 0, 0},
    {"defects/tetra_intersected_by_triangle.off", 3, 0, 0, 0, 0, 0, 0, 0, 1, 2, 1, 0},
    {"defects/three_cylinders.obj", 0, 0, 0, 0, 0, 0, 0, 0, 4899, 3, 0, 0},
    {"defects/triple_vierbein.obj", 60, 20, 3, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"defects/truck.obj", 1388, 54, 64, 55, 0, 0, 0, 0, 424, 59, 6, 0},
    {"meshes/armadillo.obj", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/fandisk.off", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/knot1.off", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/knot_orig_metro.ply", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/lucy.ply", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/plane.obj", 380, 0, 0, 0, 0, 0, 0, 0, 996, 50, 0, 0},
    {"meshes/rocker-arm.obj", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/spot.obj", 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0},
    {"meshes/stanford-bunny.obj", 223, 0, 0, 0, 0, 0, 0, 1113, 0, 1, 0, 0},
};

std::optional<TriangleMesh> read(const std::string& name) {
  const std::optional<std::string> path = find_data(name);
  if (!path) {
    WARN(name << " is not here; skipped");
    return std::nullopt;
  }
  Result<TriangleMesh> mesh = read_mesh_file(*path);
  REQUIRE(mesh.ok());
  return std::move(*mesh);
}

}  // namespace

TEST_CASE("the defects of known files are those that others count") {
  for (const Known& known : kKnown) {
    const std::optional<TriangleMesh> mesh = read(known.file);
    if (!mesh) continue;
    INFO(known.file);
    // The lattice is the one that takes long: nearly all pairs of neighbours are in a plane.
    const bool lattice = std::string(known.file) == "defects/cube_40k.obj";
    const MeshDiagnosis d =
        diagnose(*mesh, {lattice ? DiagnosisDepth::kTopology : DiagnosisDepth::kGeometry});
    CHECK(d.boundary_edges == known.boundary);
    CHECK(d.non_manifold_edges == known.non_manifold);
    CHECK(d.misoriented_edges == known.misoriented);
    CHECK(d.non_manifold_vertices == known.fans);
    CHECK(d.duplicate_triangles == known.duplicates);
    CHECK(d.opposite_duplicates == known.opposite);
    CHECK(d.zero_area_triangles == known.zero_area);
    CHECK(d.unreferenced_vertices == known.unreferenced);
    CHECK(d.self_intersections == known.self_intersections);
    CHECK_FALSE(d.self_intersections_at_least);
    CHECK(d.components == known.components);
    CHECK(d.inside_out_components == known.inside_out);
    CHECK(d.nested_components == known.nested);
    CHECK(d.cavities == (std::string(known.file) == "defects/dragon_vrip_res3.ply" ? 1 : 0));
    for (const MeshFinding& f : findings(d)) CHECK(f.example);
  }
}

TEST_CASE("known files are oriented as far as they can be") {
  for (const Known& known : kKnown) {
    const std::optional<TriangleMesh> mesh = read(known.file);
    if (!mesh) continue;
    INFO(known.file);
    const MeshDiagnosis before = diagnose(*mesh);
    const OrientedMesh out = orient(*mesh);
    const MeshDiagnosis after = diagnose(out.mesh, {DiagnosisDepth::kTopology});
    CHECK(out.closed == after.closed());
    if (before.closed()) CHECK(out.closed);
    if (out.non_orientable == 0) CHECK(after.misoriented_edges == 0);
    CHECK(after.degenerate_triangles == 0);
    CHECK(after.opposite_duplicates == 0);
    CHECK(out.components == after.components);
    CHECK(out.mesh.triangles.size() + out.degenerate_dropped + out.duplicates_dropped + out.cancelled ==
          mesh->triangles.size());
    CHECK(orient(out.mesh).turned == 0);  // once is enough
  }
}

TEST_CASE("a mesh with triangles turned at random is made whole") {
  if (const auto mesh = read("defects/blobby-shuffled.off")) {
    const OrientedMesh out = orient(*mesh);
    CHECK(out.closed);
    // The volume of the same mesh in CGAL's data, before it was shuffled.
    CHECK_THAT(signed_volume(out.mesh), Catch::Matchers::WithinAbs(0.0500825, 5e-8));
  }
  if (const auto mesh = read("defects/normal-directions-bad.stl")) {
    const OrientedMesh out = orient(*mesh);
    CHECK(out.closed);
    CHECK(out.turned == 1);
  }
  if (const auto mesh = read("defects/moebius.obj")) {
    const OrientedMesh out = orient(*mesh);
    CHECK(out.non_orientable == 1);
    CHECK(out.mesh.triangles == mesh->triangles);
  }
}
