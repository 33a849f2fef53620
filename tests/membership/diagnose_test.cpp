#include "sdk/membership/diagnose.h"

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
