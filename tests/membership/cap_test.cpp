#include "sdk/membership/cap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/membership/diagnose.h"
#include "sdk/membership/mesh_topology.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

double area(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += length(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]])) / 2;
  return sum;
}

}  // namespace

TEST_CASE("caps close any soup, with simple loops") {
  Rng rng(8);
  for (int round = 0; round < 60; ++round) {
    TriangleMesh mesh = make_torus({0, 0, 0}, 3, 1, 20, 10);
    if (round % 2) append(mesh, make_sphere({1, 0, 0}, 2, 10));
    std::vector<Triangle> kept;
    for (Triangle t : mesh.triangles) {
      if (rng.below(round % 3 == 0 ? 2 : 12) == 0) continue;
      if (round % 5 == 4 && rng.below(4) == 0) std::swap(t[0], t[1]);
      kept.push_back(t);
      if (round % 7 == 6 && rng.below(10) == 0) kept.push_back(t);
    }
    mesh.triangles = kept;
    const auto chain = boundary_chain(merge_corners(mesh));
    CHECK(!chain.empty());
    std::size_t edges = 0;
    for (const Cap& cap : cap_boundary(mesh.vertices, chain)) {
      edges += cap.loop.size();
      std::vector<std::uint32_t> loop = cap.loop;
      std::sort(loop.begin(), loop.end());
      CHECK(std::adjacent_find(loop.begin(), loop.end()) == loop.end());
      CHECK(cap.triangles.size() + 2 == loop.size());
      mesh.triangles.insert(mesh.triangles.end(), cap.triangles.begin(), cap.triangles.end());
    }
    CHECK(edges == chain.size());
    CHECK(diagnose(mesh).closed());
  }
}

TEST_CASE("a narrow crack is covered by slivers, a round hole about as by a disc") {
  // The two sides of a crack along half a circle, with vertices that do not face each other.
  TriangleMesh crack;
  constexpr int kAround = 40;
  constexpr double kWidth = 1e-4;
  std::vector<std::array<std::uint32_t, 2>> chain;
  const auto side = [&](double radius, int n, bool back) {
    for (int k = 0; k <= n; ++k) {
      const double a = 3.14159 * (back ? n - k : k) / n;
      crack.vertices.push_back({radius * std::cos(a), radius * std::sin(a), 0});
    }
  };
  side(1, kAround, false);
  side(1 - kWidth, kAround * 3 / 2, true);
  const std::uint32_t count = std::uint32_t(crack.vertices.size());
  for (std::uint32_t v = 0; v < count; ++v) chain.push_back({v, (v + 1) % count});
  const std::vector<Cap> caps = cap_boundary(crack.vertices, chain);
  REQUIRE(caps.size() == 1);
  // The arcs' chords differ by more than the crack is wide; a cone over it would have more than 1.
  CHECK(area(crack.vertices, caps[0].triangles) < 0.02);

  TriangleMesh hole = make_sphere({0, 0, 0}, 1, 40);
  std::erase_if(hole.triangles, [&](const Triangle& t) {
    return std::min({hole.vertices[t[0]].z, hole.vertices[t[1]].z, hole.vertices[t[2]].z}) > 0.9;
  });
  const std::vector<Cap> disc = cap_boundary(hole.vertices, boundary_chain(merge_corners(hole)));
  REQUIRE(disc.size() == 1);
  const double z = hole.vertices[disc[0].loop[0]].z;
  CHECK(area(hole.vertices, disc[0].triangles) == Approx(3.14159 * (1 - z * z)).epsilon(0.02));
}
