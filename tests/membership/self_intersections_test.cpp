#include "sdk/membership/self_intersections.h"

#include <array>

#include "sdk/core/rng.h"
#include "sdk/membership/triangle_triangle.h"
#include "tests/support/catch.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

using Corners = std::array<Vec3, 3>;

std::size_t shared_corners(const Corners& a, const Corners& b) {
  std::size_t shared = 0;
  for (const Vec3& p : a)
    for (const Vec3& q : b) shared += p == q;
  return shared;
}

SelfIntersections search(const TriangleMesh& mesh, const SelfIntersectionLimits& limits = {},
                         unsigned threads = 2) {
  return find_self_intersections(mesh.vertices, mesh.triangles, limits, threads);
}

std::uint64_t pairs_by_definition(const TriangleMesh& mesh) {
  std::uint64_t pairs = 0;
  const auto corners = [&](std::size_t t) {
    const Triangle& v = mesh.triangles[t];
    return Corners{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
  };
  for (std::size_t a = 0; a < mesh.triangles.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) pairs += triangles_intersect_by_definition(corners(a), corners(b));
  return pairs;
}

}  // namespace

TEST_CASE("points are collinear exactly if they are") {
  CHECK(collinear({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
  CHECK(collinear({0, 0, 5}, {0, 0, 5}, {1, 2, 3}));
  CHECK_FALSE(collinear({0.1, 0.1, 1}, {0.2, 0.2, 1}, {0.3, 0.1 + 0.2, 1}));  // 0.1 + 0.2 is not 0.3
  CHECK_FALSE(collinear({0, 0, 0}, {1, 1, 1}, {3, 3, 0x1.8000000000001p1}));
}

TEST_CASE("triangles intersect if their exact clipping says so") {
  // Corners on a small lattice touch, share and overlap in all ways; a lattice whose steps are no binary
  // fractions makes many nearly so.
  Rng rng(1);
  std::array<std::array<int, 2>, 3> seen{};  // by shared corners, by answer
  const std::array<double, 3> steps{1.0, 0.1, 1e-20};
  for (int k = 0; k < 30000; ++k) {
    const std::uint32_t side = 2 + rng.below(3), depth = rng.below(4) == 0 ? 1 : side;
    const double step = steps[rng.below(3)];
    const auto corner = [&] {
      return Vec3{rng.below(side) * step, rng.below(side) * step + 7 * step, rng.below(depth) * step};
    };
    const Corners a{corner(), corner(), corner()};
    Corners b{corner(), corner(), corner()};
    for (std::uint32_t n = rng.below(3); n > 0; --n) b[n] = a[(n + rng.below(2)) % 3];
    if (collinear(a[0], a[1], a[2]) || collinear(b[0], b[1], b[2])) continue;
    const bool expected = triangles_intersect_by_definition(a, b);
    if (const std::size_t shared = shared_corners(a, b); shared < 3) ++seen[shared][expected];
    INFO(k);
    REQUIRE(triangles_intersect(a, b) == expected);
    REQUIRE(triangles_intersect(b, a) == expected);
    REQUIRE(triangles_intersect({a[1], a[2], a[0]}, {b[0], b[2], b[1]}) == expected);
  }
  for (const auto& by_answer : seen)
    for (const int n : by_answer) CHECK(n > 300);
}

TEST_CASE("triangles in general position intersect if their exact clipping says so") {
  Rng rng(2);
  int met = 0;
  for (int k = 0; k < 5000; ++k) {
    const auto corner = [&] { return Vec3{rng.uniform(), rng.uniform(), rng.uniform()}; };
    const Corners a{corner(), corner(), corner()}, b{corner(), corner(), corner()};
    const bool expected = triangles_intersect_by_definition(a, b);
    met += expected;
    REQUIRE(triangles_intersect(a, b) == expected);
  }
  CHECK(met > 500);
}

TEST_CASE("sound meshes do not intersect themselves") {
  CHECK(search(make_sphere({0, 0, 0}, 1, 20)).pairs == 0);
  CHECK(search(make_torus({0, 0, 0}, 2, 0.5, 40, 20)).pairs == 0);
  const SelfIntersections none = search({});
  CHECK(none.pairs == 0);
  CHECK_FALSE(none.at_least);
  CHECK_FALSE(none.example);
}

TEST_CASE("pairs that intersect are counted") {
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 5);
  append(mesh, make_sphere({1, 0.25, 0}, 1, 4));
  append(mesh, make_box({-0.5, -0.5, 0}, {0.5, 0.5, 3}));
  append(mesh, make_box({0.5, 0, 0}, {1, 0.5, 3}));  // touches the box before it
  const std::uint64_t expected = pairs_by_definition(mesh);
  REQUIRE(expected > 50);
  for (const unsigned threads : {1u, 4u}) {
    const SelfIntersections found = search(mesh, {}, threads);
    CHECK(found.pairs == expected);
    CHECK_FALSE(found.at_least);
    REQUIRE(found.example);
    CHECK(bounding_box(mesh).min.x <= found.example->x);
    CHECK(found.example->x <= bounding_box(mesh).max.x);
    CHECK(*found.example == *search(mesh).example);
  }

  const SelfIntersections some = search(mesh, {expected - 1});
  CHECK(some.pairs == expected - 1);
  CHECK(some.at_least);
  CHECK_FALSE(search(mesh, {expected}).at_least);
}

TEST_CASE("triangles of area zero and duplicates are no self-intersections") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.vertices.push_back({0.5, 0, 0});
  mesh.vertices.push_back({0.25, 0, 0});
  mesh.triangles.push_back({0, 8, 9});
  CHECK(search(mesh).pairs == 0);
}

TEST_CASE("a mesh that meets itself everywhere is left soon") {
  // 20000 triangles through one point: 2e8 pairs.
  TriangleMesh mesh;
  Rng rng(3);
  for (std::uint32_t k = 0; k < 20000; ++k) {
    const Vec3 a{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const Vec3 b{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    mesh.vertices.insert(mesh.vertices.end(), {a, b, a * -1.0 + b * -0.5});
    mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const SelfIntersections found = search(mesh, {1000});
  CHECK(found.pairs == 1000);
  CHECK(found.at_least);
  CHECK(search(mesh, {1'000'000'000, 1000}).at_least);

  std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  CHECK(find_self_intersections(mesh.vertices, mesh.triangles, {}, 2, &progress).at_least);
}
