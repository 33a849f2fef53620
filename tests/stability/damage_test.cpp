#include "converters/stability/damage.h"

#include <cmath>
#include <set>

#include "converters/stability/catalogue.h"
#include "sdk/core/primitives.h"
#include "sdk/membership/diagnose.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]];
    sum += length(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a)) / 2;
  }
  return sum;
}

double largest_area(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]];
    largest = std::max(largest, length(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a)) / 2);
  }
  return largest;
}

MeshDiagnosis diagnosis(const TriangleMesh& mesh) { return diagnose(mesh, {DiagnosisDepth::kTopology}); }

}  // namespace

TEST_CASE("clean meshes are closed, outward and without self-intersections") {
  for (const NamedMesh& named : clean_meshes()) {
    CAPTURE(named.name);
    const MeshDiagnosis d = diagnose(named.mesh, {DiagnosisDepth::kGeometry});
    CHECK(d.closed());
    CHECK(d.components == 1);
    CHECK(d.self_intersections == 0);
    CHECK(d.non_manifold_vertices == 0);
    CHECK(d.zero_area_triangles == 0);
    CHECK(signed_volume(named.mesh) > 0);
    CHECK(named.mesh.triangles.size() > 1500);
    CHECK(named.mesh.triangles.size() < 2500);
  }
}

TEST_CASE("holes have the area that was asked for, to within three triangles") {
  for (const NamedMesh& named : clean_meshes())
    for (const double share : {0.001, 0.01, 0.05, 0.1}) {
      CAPTURE(named.name, share);
      const TriangleMesh broken = punch_holes(named.mesh, share, 1);
      const double taken = area(named.mesh) - area(broken);
      CHECK(taken >= share * area(named.mesh) * (1 - 1e-9));
      CHECK(taken <= share * area(named.mesh) + 3 * largest_area(named.mesh));
      const MeshDiagnosis d = diagnosis(broken);
      CHECK(d.boundary_edges > 0);
      CHECK(d.components == 1);
    }
}

TEST_CASE("damage has the strength that was asked for") {
  const TriangleMesh mesh = make_torus(1, 0.4, 50, 20);
  const std::size_t all = mesh.triangles.size();
  REQUIRE(all == 2000);
  CHECK(remove_triangles(mesh, 0.01, 1).triangles.size() == all - 20);
  CHECK(duplicate_triangles(mesh, 0.1, 1).triangles.size() == all + 200);
  CHECK(diagnosis(duplicate_triangles(mesh, 0.1, 1)).duplicate_triangles == 200);
  CHECK(diagnosis(duplicate_turned(mesh, 0.1, 1)).opposite_duplicates == 200);
  CHECK(diagnosis(duplicate_turned(mesh, 0.1, 1)).closed() == false);

  const TriangleMesh flipped = flip_triangles(mesh, 0.05, 1);
  std::size_t turned = 0;
  for (std::size_t t = 0; t < all; ++t) turned += flipped.triangles[t] != mesh.triangles[t];
  CHECK(turned == 100);
  CHECK(diagnosis(flipped).misoriented_edges > 200);

  const double diagonal = length(bounding_box(mesh).extent());
  const TriangleMesh jittered = jitter_vertices(mesh, 1e-3, 1);
  CHECK(diagnosis(jittered).closed());
  double moved = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    moved = std::max(moved, length(jittered.vertices[v] - mesh.vertices[v]));
  CHECK(moved <= std::sqrt(3.0) * 1e-3 * diagonal);
  CHECK(moved > 1e-3 * diagonal);

  const TriangleMesh torn = jitter_corners(mesh, 1e-4, 1);
  CHECK(torn.vertices.size() == 3 * all);
  CHECK(diagnosis(torn).boundary_edges == 3 * all);

  const TriangleMesh cracked = crack(mesh, 1e-4, 1);
  CHECK(cracked.triangles.size() == all);
  CHECK(diagnosis(cracked).components > 5);
  CHECK(diagnosis(cracked).components <= 13);
  CHECK(std::abs(area(cracked) - area(mesh)) < 1e-9);

  const Vec3 grown = bounding_box(add_spikes(mesh, 0.01, 1)).extent() - bounding_box(mesh).extent();
  CHECK(length(grown) > 0.1 * diagonal);

  const TriangleMesh slivers = add_slivers(mesh, 0.1, 1);
  CHECK(slivers.triangles.size() == all + 400);
  CHECK(diagnosis(slivers).closed());
  CHECK(std::abs(area(slivers) - area(mesh)) < 1e-9);

  const TriangleMesh internal = add_internal_faces(mesh, 0.1, 1);
  CHECK(internal.triangles.size() > all + 100);
  CHECK(bounding_box(internal).extent() == bounding_box(mesh).extent());
  CHECK(diagnosis(internal).boundary_edges > 0);
}

TEST_CASE("damage is the same for the same seed and another for another one") {
  const TriangleMesh mesh = make_torus(1, 0.4, 50, 20);
  for (const Damage& damage : damages()) {
    CAPTURE(damage.name);
    const TriangleMesh a = damage.apply(mesh, 0.05, 7), b = damage.apply(mesh, 0.05, 7);
    CHECK((a.vertices == b.vertices && a.triangles == b.triangles));
    const TriangleMesh c = damage.apply(mesh, 0.05, 8);
    CHECK(!(a.vertices == c.vertices && a.triangles == c.triangles));
  }
}

TEST_CASE("the catalogue has all groups, and its sound meshes are closed and in their grids") {
  const std::vector<NamedMesh> meshes = clean_meshes();
  std::vector<StabilityCase> cases = damage_cases(meshes, 24);
  std::ranges::move(geometry_cases(24), std::back_inserter(cases));
  std::set<std::string> groups, names;
  for (const StabilityCase& c : cases) {
    CAPTURE(c.row(), c.mesh);
    groups.insert(c.group);
    names.insert(c.name);
    CHECK(diagnose(c.sound).closed());
    const Box3 box = bounding_box(c.sound);
    for (std::size_t a = 0; a < 3; ++a) {
      CHECK(box.min[a] > 0);
      CHECK(box.max[a] < c.size[a]);
    }
  }
  CHECK(groups == std::set<std::string>{"clean", "damage", "geometry"});
  CHECK(names.size() > damages().size() + 8);
}
