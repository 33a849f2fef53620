#include "sdk/membership/orient.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "converters/import/mesh_file.h"
#include "sdk/core/rng.h"
#include "sdk/membership/diagnose.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using Catch::Matchers::WithinRel;

namespace {

void turn(Triangle& t) { std::swap(t[1], t[2]); }

/// Turns about one triangle in two.
TriangleMesh turn_some(TriangleMesh mesh, std::uint64_t seed) {
  Rng rng(seed);
  for (Triangle& t : mesh.triangles)
    if (rng.below(2)) turn(t);
  return mesh;
}

/// A strip of 2 × `steps` triangles about the z axis with a half turn in it.
TriangleMesh make_moebius(std::uint32_t steps) {
  TriangleMesh m;
  for (std::uint32_t k = 0; k < steps; ++k) {
    const double u = 2 * std::numbers::pi * k / steps;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(u / 2);
      m.vertices.push_back({r * std::cos(u), r * std::sin(u), s * std::sin(u / 2)});
    }
  }
  for (std::uint32_t k = 0; k < steps; ++k) {
    const std::uint32_t a = 2 * k, b = a + 1;
    std::uint32_t c = (a + 2) % (2 * steps), d = c + 1;
    if (k + 1 == steps) std::swap(c, d);
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({b, d, c});
  }
  return m;
}

bool contains(const TriangleMesh& mesh, const TriangleMesh& part) {
  return std::all_of(part.triangles.begin(), part.triangles.end(), [&](const Triangle& t) {
    return std::find(mesh.triangles.begin(), mesh.triangles.end(), t) != mesh.triangles.end();
  });
}

}  // namespace

TEST_CASE("a sound mesh is left as it is") {
  TriangleMesh mesh = make_torus({0, 0, 0}, 2, 0.5, 20, 10);
  mesh.colors.assign(mesh.vertices.size(), Rgb8{1, 2, 3});
  mesh.vertices.push_back({9, 9, 9});  // that no triangle uses
  mesh.colors.push_back({4, 5, 6});
  const OrientedMesh out = orient(mesh);
  CHECK(out.mesh.vertices == mesh.vertices);
  CHECK(out.mesh.triangles == mesh.triangles);
  CHECK(out.mesh.colors == mesh.colors);
  CHECK(out.closed);
  CHECK(out.turned == 0);
  CHECK(out.components == 1);
  CHECK(out.patches == 1);
}

TEST_CASE("triangles turned at random are turned back") {
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 10);
  append(mesh, make_torus({10, 0, 0}, 2, 0.5, 20, 10));
  append(mesh, make_box({3, 3, 3}, {4, 5, 6}));
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const TriangleMesh bad = turn_some(mesh, seed);
    REQUIRE_FALSE(diagnose(bad).closed());
    const OrientedMesh out = orient(bad);
    CHECK(out.closed);
    CHECK(out.components == 3);
    CHECK(out.turned > 100);
    CHECK(diagnose(out.mesh).closed());
    CHECK_THAT(signed_volume(out.mesh), WithinRel(signed_volume(mesh), 1e-12));
    std::size_t same = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Triangle expected = mesh.triangles[t], found = out.mesh.triangles[t];
      std::rotate(expected.begin(), std::min_element(expected.begin(), expected.end()), expected.end());
      std::rotate(found.begin(), std::min_element(found.begin(), found.end()), found.end());
      same += expected == found;
    }
    CHECK(same == mesh.triangles.size());
  }
}

TEST_CASE("triangles that do not share vertices are oriented by the places of their corners") {
  const TriangleMesh box = turn_some(make_box({0, 0, 0}, {1, 1, 1}), 3);
  TriangleMesh soup;
  for (const Triangle& t : box.triangles) {
    for (const std::uint32_t v : t) soup.vertices.push_back(box.vertices[v]);
    const std::uint32_t n = std::uint32_t(soup.vertices.size());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  const OrientedMesh out = orient(soup);
  CHECK(out.closed);
  CHECK(out.mesh.vertices.size() == 36);
  CHECK(signed_volume(out.mesh) == 1);
}

TEST_CASE("a part that is inside out is turned, a cavity is not") {
  TriangleMesh outer = make_box({0, 0, 0}, {10, 10, 10}), inner = make_box({2, 2, 2}, {4, 4, 4});
  TriangleMesh apart = make_box({20, 0, 0}, {22, 2, 2});

  TriangleMesh reversed = outer;
  flip(reversed);
  OrientedMesh out = orient(reversed);
  CHECK(out.turned == 12);
  CHECK(signed_volume(out.mesh) == 1000);

  TriangleMesh hollow = outer, cavity = inner;
  flip(cavity);
  append(hollow, cavity);
  out = orient(hollow);
  CHECK(out.closed);
  CHECK(out.turned == 0);
  CHECK(signed_volume(out.mesh) == 992);

  // The mirror image of it is turned as a whole, and what is beside it on its own.
  TriangleMesh mirrored = hollow;
  flip(mirrored);
  append(mirrored, apart);
  out = orient(mirrored);
  CHECK(out.turned == 24);
  CHECK(signed_volume(out.mesh) == 1000);

  // An island in the cavity, given first.
  TriangleMesh island = make_box({2.5, 2.5, 2.5}, {3, 3, 3});
  append(island, mirrored);
  flip(island);
  out = orient(island);
  CHECK(out.turned == 12);  // what is apart

  // A shell of the same orientation is left to the winding number, which unites.
  TriangleMesh buried = outer;
  append(buried, inner);
  CHECK(orient(buried).turned == 0);

  // A cavity one of whose triangles is wrong stays one.
  TriangleMesh flawed = hollow;
  turn(flawed.triangles.back());
  out = orient(flawed);
  CHECK(out.turned == 1);
  CHECK(signed_volume(out.mesh) == 992);

  // Parts that cross are both made outward.
  TriangleMesh crossing = outer, other = make_box({9, 9, 9}, {12, 12, 12});
  flip(other);
  append(crossing, other);
  CHECK(signed_volume(orient(crossing).mesh) == 1027);
}

TEST_CASE("degenerate triangles are dropped") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({0, 0, 1});
  mesh.vertices.push_back(mesh.vertices[3]);
  mesh.triangles.push_back({3, 8, 1});
  const OrientedMesh out = orient(mesh);
  CHECK(out.degenerate_dropped == 2);
  CHECK(out.mesh.triangles.size() == 12);
  CHECK(out.closed);

  const OrientedMesh none = orient({{{0, 0, 0}}, {{0, 0, 0}}});
  CHECK_FALSE(none.closed);
  CHECK(none.components == 0);
  CHECK_FALSE(orient({}).closed);
}

TEST_CASE("of duplicates in a sound mesh one is kept") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.triangles.push_back(mesh.triangles[1]);
  turn(mesh.triangles.back());
  mesh.triangles.push_back(mesh.triangles[5]);
  mesh.triangles.push_back(mesh.triangles[5]);  // three of them now
  const OrientedMesh out = orient(mesh);
  CHECK(out.duplicates_dropped == 4);
  CHECK(out.cancelled == 0);
  CHECK(out.closed);
  CHECK(signed_volume(out.mesh) == 1);
}

TEST_CASE("a surface whose every triangle was given twice is kept once") {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  TriangleMesh twice = box, back = box;
  append(twice, box);
  CHECK(signed_volume(orient(twice).mesh) == 2);  // closed as it is: nothing to repair
  flip(back);
  TriangleMesh both = box;
  append(both, back);
  OrientedMesh out = orient(both);
  CHECK(out.duplicates_dropped == 12);
  CHECK(out.closed);
  CHECK(signed_volume(out.mesh) == 1);
  out = orient(turn_some(twice, 7));
  CHECK(out.closed);
  CHECK(signed_volume(out.mesh) == 1);
}

TEST_CASE("walls between the elements of a solid cancel, however they are oriented") {
  TriangleMesh solid;
  for (int k = 0; k < 27; ++k) {
    const Vec3 low{double(k % 3), double(k / 3 % 3), double(k / 9)};
    append(solid, make_box(low, low + Vec3{1, 1, 1}));
  }
  OrientedMesh out = orient(solid);
  // The diagonals of opposite sides of make_box() fit, so each of the 54 walls is there twice.
  CHECK(out.cancelled == 54 * 4);
  CHECK(out.mesh.triangles.size() == 54 * 2);
  CHECK(out.closed);
  CHECK(signed_volume(out.mesh) == 27);
  out = orient(turn_some(solid, 11));
  CHECK(out.cancelled == 54 * 4);
  CHECK(out.closed);
  CHECK(signed_volume(out.mesh) == 27);
}

TEST_CASE("solids whose equal sides coincide stay united") {
  // Both boxes have the side x = 0, with the same triangles; all edges balance.
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  append(mesh, make_box({0, 0, 0}, {2, 1, 1}));
  REQUIRE(diagnose(mesh).closed());
  const OrientedMesh out = orient(mesh);
  CHECK(out.mesh.triangles == mesh.triangles);
  CHECK(out.closed);
}

TEST_CASE("a patch between edges of many triangles is made consistent in itself") {
  TriangleMesh two = make_box({0, 0, 0}, {1, 1, 1});
  append(two, make_box({1, 1, 0}, {2, 2, 1}));  // they share an edge
  const OrientedMesh out = orient(turn_some(two, 5));
  CHECK(out.closed);
  CHECK(out.components == 1);
  CHECK(out.patches == 2);
  CHECK(signed_volume(out.mesh) == 2);
}

TEST_CASE("what has one side only is told and left") {
  TriangleMesh mesh = make_moebius(12);
  const std::vector<Triangle> before = mesh.triangles;
  append(mesh, turn_some(make_box({5, 5, 5}, {6, 6, 6}), 2));
  const OrientedMesh out = orient(mesh);
  CHECK(out.non_orientable == 1);
  CHECK(out.non_orientable_example == mesh.vertices[0]);
  CHECK_FALSE(out.closed);
  CHECK(std::equal(before.begin(), before.end(), out.mesh.triangles.begin()));
  CHECK(contains(out.mesh, {{}, before}));
  CHECK(diagnose(out.mesh).misoriented_edges == diagnose(make_moebius(12)).misoriented_edges);
}
