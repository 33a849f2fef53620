#include "sdk/trace/scene.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "sdk/shade/render.h"
#include "sdk/trace/exact.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

Vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

Transform random_transform(Rng& rng) {
  Transform t;
  do {
    for (Vec3& row : t.rows) row = random_vector(rng, 1);
    // Also mirrored ones, but none that is almost flat.
  } while (std::abs(dot(t.rows[0], cross(t.rows[1], t.rows[2]))) < 0.2);
  t.move = random_vector(rng, 20);
  return t;
}

double distance(Vec3 a, Vec3 b) { return length(a - b); }

}  // namespace

TEST_CASE("transforms compose, invert and rotate as defined") {
  Rng rng(5);
  for (int round = 0; round < 100; ++round) {
    const Transform a = random_transform(rng), b = random_transform(rng);
    const Vec3 p = random_vector(rng, 10);
    CHECK(distance((a * b).point(p), a.point(b.point(p))) < 1e-12);
    REQUIRE(a.inverse());
    CHECK(distance(a.inverse()->point(a.point(p)), p) < 1e-11);
  }
  const Transform turn = rotation({0, 0, 2}, std::numbers::pi / 2);
  CHECK(distance(turn.point({1, 0, 5}), {0, 1, 5}) < 1e-15);
  CHECK(distance(rotation({1, 1, 1}, 2 * std::numbers::pi / 3).point({1, 2, 3}), {3, 1, 2}) < 1e-14);
  CHECK((translation({1, 2, 3}) * scaling({2, 3, 4})).point({1, 1, 1}) == Vec3{3, 5, 7});
  CHECK(!scaling({1, 0, 1}).inverse());
  CHECK(!scaling({1, std::numeric_limits<double>::infinity(), 1}).inverse());
  CHECK(!translation({0, std::nan(""), 1}).inverse());
}

TEST_CASE("a placed asset is hit where a ray in its own space hits it") {
  Rng rng(11);
  const CellObject object = random_object(rng, "spheres:cells=6,resolution=12", {3, 2, 2}, 0.6);
  const auto own = make_exact_caster(object);
  int hits = 0;
  for (int round = 0; round < 40; ++round) {
    const Transform to_scene = random_transform(rng), back = *to_scene.inverse();
    const auto scene = make_scene({{own.get(), to_scene}});
    REQUIRE(scene);
    const Box3 box = (*scene)->object_box();
    for (int k = 0; k < 200; ++k) {
      const Vec3 from = to_scene.point(random_vector(rng, 60)), to = to_scene.point(random_vector(rng, 30));
      const Ray ray{from, normalize(to - from)};
      Hit hit, expected;
      const bool any = (*scene)->first_hit(ray, hit);
      REQUIRE(any == own->first_hit({back.point(ray.origin), back.direction(ray.direction)}, expected));
      if (!any) continue;
      ++hits;
      REQUIRE(hit.t == expected.t);
      REQUIRE(hit.element == expected.element);
      const Vec3 point = ray.origin + ray.direction * hit.t;
      for (std::size_t a = 0; a < 3; ++a) {
        REQUIRE(point[a] >= box.min[a]);
        REQUIRE(point[a] <= box.max[a]);
      }
      // A face's normal is that of two of its edges, transformed.
      if (expected.face_normal == Vec3{}) continue;
      const Vec3 n = expected.face_normal;
      const Vec3 edge = std::abs(n.x) > 0.5 ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, other = cross(n, edge);
      REQUIRE(std::abs(dot(hit.face_normal, normalize(to_scene.direction(edge)))) < 1e-12);
      REQUIRE(std::abs(dot(hit.face_normal, normalize(to_scene.direction(other)))) < 1e-12);
      REQUIRE(dot(hit.face_normal, to_scene.direction(n)) > 0);
      const Vec3 shading = (*scene)->shading_normal(hit);
      REQUIRE(length(shading) == Approx(1));
      REQUIRE((*scene)->color(hit, point) == own->color(expected, back.point(point)));
    }
  }
  CHECK(hits > 300);
}

TEST_CASE("of several assets the nearest is hit, and a ray leaves their union where none is left") {
  Rng rng(12);
  const CellObject a = random_object(rng, "voronoi:cells=4,resolution=8", {3, 3, 3}, 0.7),
                   b = random_object(rng, "voronoi:cells=6,resolution=8", {3, 3, 3}, 0.9);
  const auto cast_a = make_exact_caster(a), cast_b = make_exact_caster(b);
  const std::vector<Placement> placements = {
      {cast_a.get(), translation({-3, 2, 0})},
      {cast_b.get(), rotation({1, 2, 3}, 1) * scaling({1.5, 1.5, 1.5})},
      {cast_b.get(), translation({8, 8, 8}) * scaling({-1, 1, 1})}};
  const auto scene = make_scene(placements);
  REQUIRE(scene);
  CHECK((*scene)->detail() == Approx(1.0 / std::sqrt(3.0)));
  std::vector<int> counts(3, 0);
  int exits = 0, handed_over = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 from = random_vector(rng, 24);
    const Ray ray{from, k % 2 ? random_vector(rng, 1) : normalize(random_vector(rng, 14) - from)};
    Hit nearest, hit;
    bool any = false;
    for (const Placement& p : placements) {
      const Transform back = *p.to_scene.inverse();
      Hit found;
      if (!p.caster->first_hit({back.point(ray.origin), back.direction(ray.direction)}, found)) continue;
      if (any && found.t >= nearest.t) continue;
      any = true;
      nearest = found;
      nearest.placement = std::uint32_t(&p - placements.data());
    }
    REQUIRE((*scene)->first_hit(ray, hit) == any);
    if (any) {
      REQUIRE(hit.t == nearest.t);
      REQUIRE(hit.placement == nearest.placement);
      ++counts[hit.placement];
    }
    Hit exit;
    REQUIRE((*scene)->first_exit(ray, exit) == (*scene)->inside(from));
    if (!(*scene)->inside(from)) continue;
    ++exits;
    // All of the way is inside, and right behind it is not.
    const double step = 1e-6 / length(ray.direction);
    for (int s = 0; s < 50; ++s) {
      const double t = exit.t * (s + 0.5) / 50;
      REQUIRE((*scene)->inside(ray.origin + ray.direction * t));
    }
    REQUIRE(!(*scene)->inside(ray.origin + ray.direction * (exit.t + step)));
    Hit alone;
    const Transform back = *placements[0].to_scene.inverse();
    if (cast_a->first_exit({back.point(ray.origin), back.direction(ray.direction)}, alone))
      handed_over += alone.t < exit.t;
  }
  CHECK(counts[0] > 500);
  CHECK(counts[1] > 200);
  CHECK(counts[2] > 200);
  CHECK(exits > 300);
  CHECK(handed_over > 10);
}

TEST_CASE("a scene is rendered like any asset, and a wrong one is refused") {
  Rng rng(13);
  const CellObject object = random_object(rng, "spheres:cells=3,resolution=8", {2, 2, 2}, 1);
  const auto caster = make_exact_caster(object);
  const auto scene = make_scene({{caster.get(), {}}, {caster.get(), translation({40, 0, 0})}});
  REQUIRE(scene);
  const Result<RenderResult> picture = render(**scene, {.width = 80, .height = 40});
  REQUIRE(picture);
  CHECK(picture->hits > 100);
  CHECK(make_scene({}).error().code == ErrorCode::kUsage);
  CHECK(make_scene({{nullptr, {}}}).error().code == ErrorCode::kUsage);
  CHECK(make_scene({{caster.get(), scaling({1, 0, 1})}}).error().code == ErrorCode::kUsage);
  CHECK(make_scene({{caster.get(), translation({1e308, 1e308, 0})}, {caster.get(), scaling({1e308, 1, 1})}})
            .error()
            .code == ErrorCode::kUsage);
}
