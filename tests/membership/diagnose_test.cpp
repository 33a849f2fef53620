#include "sdk/membership/diagnose.h"

#include <algorithm>

#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

TEST_CASE("closed meshes are closed") {
  CHECK(diagnose(make_box({0, 0, 0}, {1, 2, 3})).closed());
  CHECK(diagnose(make_sphere({5, 5, 5}, 2, 12)).closed());
  CHECK(diagnose(make_torus({0, 0, 0}, 2, 0.5, 20, 10)).closed());
  TriangleMesh two = make_box({0, 0, 0}, {1, 1, 1});
  append(two, make_box({1, 0, 0}, {2, 1, 1}));  // share a face: four triangles at its edges, but balanced
  const MeshDiagnosis d = diagnose(two);
  CHECK(d.closed());
  CHECK(d.non_manifold_edges > 0);
  TriangleMesh inside_out = make_box({0, 0, 0}, {1, 1, 1});
  flip(inside_out);
  CHECK(diagnose(inside_out).closed());
}

TEST_CASE("a mesh of separate triangles is closed if their corners coincide") {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  TriangleMesh soup;
  for (const Triangle& t : box.triangles) {
    for (const std::uint32_t v : t) soup.vertices.push_back(box.vertices[v]);
    const std::uint32_t n = std::uint32_t(soup.vertices.size());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  CHECK(diagnose(soup).closed());
  soup.vertices[4].x += 1e-9;
  CHECK_FALSE(diagnose(soup).closed());
}

TEST_CASE("what is wrong with a mesh is counted and told") {
  TriangleMesh open = make_box({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  MeshDiagnosis d = diagnose(open);
  CHECK_FALSE(d.closed());
  CHECK(d.boundary_edges == 3);
  CHECK(describe(d).find("3 boundary edges") != std::string::npos);
  CHECK(describe(d).find("first near") != std::string::npos);

  TriangleMesh flipped = make_box({0, 0, 0}, {1, 1, 1});
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  d = diagnose(flipped);
  CHECK_FALSE(d.closed());
  CHECK(d.misoriented_edges == 3);

  TriangleMesh doubled = make_box({0, 0, 0}, {1, 1, 1});
  doubled.triangles.push_back(doubled.triangles[0]);
  d = diagnose(doubled);
  CHECK_FALSE(d.closed());
  CHECK(d.non_manifold_edges == 3);

  TriangleMesh degenerate = make_box({0, 0, 0}, {1, 1, 1});
  degenerate.triangles.push_back({0, 0, 1});
  d = diagnose(degenerate);
  CHECK(d.closed());
  CHECK(d.degenerate_triangles == 1);

  CHECK(describe(diagnose({})) == "the mesh has no triangles");
  CHECK_FALSE(diagnose({{{0, 0, 0}}, {{0, 0, 0}}}).closed());
}

namespace {

MeshDiagnosis diagnose_all(const TriangleMesh& mesh) { return diagnose(mesh, {DiagnosisDepth::kGeometry}); }

std::optional<Vec3> example(const MeshDiagnosis& d, MeshDefect defect) {
  return d.examples[std::size_t(defect)];
}

}  // namespace

TEST_CASE("a sound mesh has no findings, at any depth") {
  TriangleMesh mesh = make_torus({0, 0, 0}, 2, 0.5, 20, 10);
  for (const DiagnosisDepth depth :
       {DiagnosisDepth::kEdges, DiagnosisDepth::kTopology, DiagnosisDepth::kGeometry}) {
    const MeshDiagnosis d = diagnose(mesh, {depth});
    CHECK(d.depth == depth);
    CHECK(findings(d).empty());
  }
  CHECK(diagnose_all(mesh).components == 1);
  CHECK(diagnose_all(mesh).closed_components == 1);
  CHECK(diagnose_all({}).components == 0);
}

TEST_CASE("vertices with several fans are found") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  append(mesh, make_box({1, 1, 1}, {2, 2, 2}));  // shares a corner
  MeshDiagnosis d = diagnose_all(mesh);
  CHECK(d.non_manifold_vertices == 1);
  CHECK(example(d, MeshDefect::kNonManifoldVertex) == Vec3{1, 1, 1});
  CHECK(d.components == 2);
  CHECK(d.self_intersections == 0);

  mesh = make_box({0, 0, 0}, {1, 1, 1});
  append(mesh, make_box({1, 1, 0}, {2, 2, 1}));  // shares an edge, so its ends have one fan
  d = diagnose_all(mesh);
  CHECK(d.non_manifold_edges == 1);
  CHECK(example(d, MeshDefect::kNonManifoldEdge) == Vec3{1, 1, 0.5});
  CHECK(d.non_manifold_vertices == 0);
  CHECK(d.components == 1);
}

TEST_CASE("duplicates are told by their orientation") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  const Triangle t = mesh.triangles[3];
  mesh.triangles.insert(mesh.triangles.end(),
                        {{t[1], t[2], t[0]}, {t[0], t[2], t[1]}, {t[2], t[1], t[0]}, t});
  const MeshDiagnosis d = diagnose_all(mesh);
  CHECK(d.duplicate_triangles == 3);  // two more one way, one more the other way
  CHECK(d.opposite_duplicates == 2);
  CHECK(example(d, MeshDefect::kDuplicate) == example(d, MeshDefect::kOppositeDuplicate));
  CHECK(d.self_intersections == 0);
}

TEST_CASE("areas of zero and vertices without triangles are found") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  mesh.vertices.insert(mesh.vertices.end(), {{0.5, 0, 0}, {7, 8, 9}, {7, 8, 9}, {1, 1, 1}});
  mesh.triangles.push_back({0, 8, 1});
  MeshDiagnosis d = diagnose_all(mesh);
  CHECK(d.zero_area_triangles == 1);
  CHECK(example(d, MeshDefect::kZeroArea) == Vec3{0.5, 0, 0});
  CHECK(d.unreferenced_vertices == 1);  // places; that of the last one is used
  CHECK(example(d, MeshDefect::kUnreferencedVertex) == Vec3{7, 8, 9});
  mesh.vertices[8].y = 1e-300;
  d = diagnose_all(mesh);
  CHECK(d.zero_area_triangles == 0);
}

TEST_CASE("what is inside what is told from what is inside out") {
  const TriangleMesh outer = make_box({0, 0, 0}, {10, 10, 10}), inner = make_box({2, 2, 2}, {4, 4, 4});
  TriangleMesh hollow = inner;
  flip(hollow);
  append(hollow, outer);
  MeshDiagnosis d = diagnose_all(hollow);
  CHECK(d.closed_components == 2);
  CHECK(d.nested_components == 1);
  CHECK(d.cavities == 1);
  CHECK(d.inside_out_components == 0);
  CHECK(example(d, MeshDefect::kNested) == Vec3{2, 2, 2});
  CHECK(diagnose(hollow, {DiagnosisDepth::kTopology}).inside_out_components == 1);

  TriangleMesh mirrored = hollow;
  flip(mirrored);
  d = diagnose_all(mirrored);
  CHECK(d.inside_out_components == 1);
  CHECK(d.cavities == 1);

  TriangleMesh buried = outer;
  append(buried, inner);
  d = diagnose_all(buried);
  CHECK(d.nested_components == 1);
  CHECK(d.cavities == 0);

  // Inside the box of a torus, and in its hole.
  TriangleMesh ring = make_torus({0, 0, 0}, 2, 0.5, 20, 10);
  append(ring, make_box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}));
  append(ring, make_box({1.9, -0.1, -0.1}, {2.1, 0.1, 0.1}));  // in its tube
  CHECK(diagnose_all(ring).nested_components == 1);

  // Leaning on the wall from within, on all sides in turn; leaning on it from without; and through it.
  for (const Vec3 low : {Vec3{0, 4, 4}, {4, 0, 4}, {4, 4, 0}, {8, 4, 4}, {4, 8, 4}, {4, 4, 8}, {8, 8, 8}}) {
    TriangleMesh leaning = outer;
    append(leaning, make_box(low, low + Vec3{2, 2, 2}));
    CHECK(diagnose_all(leaning).nested_components == 1);
  }
  TriangleMesh arch = make_torus({0, 0, 0}, 2, 0.5, 20, 10);
  append(arch, make_box({1.9, -0.1, -0.1}, {2.1, 0.1, 0.4}));
  CHECK(diagnose_all(arch).nested_components == 1);
  arch.vertices.back() = {2.1, 2, 0.4};
  CHECK(diagnose_all(arch).nested_components == 0);
}

TEST_CASE("shells in shells are all found") {
  TriangleMesh onion;
  for (int k = 50; k > 0; --k)
    append(onion, make_box({-1.0 * k, -1.0 * k, -1.0 * k}, {1.0 * k, 1.0 * k, 1.0 * k}));
  const MeshDiagnosis d = diagnose_all(onion);
  CHECK(d.closed_components == 50);
  CHECK(d.nested_components == 49);
  CHECK(d.cavities == 0);
}

TEST_CASE("every finding has a line for people and an id for machines") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  append(mesh, make_box({0.25, 0.25, 0.5}, {0.75, 0.75, 3}));
  const MeshDiagnosis d = diagnose(mesh, {DiagnosisDepth::kGeometry, 4});
  std::vector<std::string> ids, lines;
  for (const MeshFinding& f : findings(d)) {
    ids.push_back(f.id);
    lines.push_back(describe(f));
    CHECK(f.example);
  }
  CHECK(ids == std::vector<std::string>{"boundary-edges", "unbalanced-edges", "self-intersections"});
  CHECK(lines[0].starts_with("3 boundary edges, the first near ("));
  CHECK(lines[2].starts_with("at least 4 pairs of triangles that intersect, the first near ("));
}
