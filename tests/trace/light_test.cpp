#include <cmath>
#include <numbers>

#include "sdk/author/cell_object.h"
#include "sdk/shade/clip.h"
#include "sdk/shade/render.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/linear.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

CellObject slab() {
  return make_blocks({9, 9, 3}, 8, [](std::uint32_t, std::uint32_t, std::uint32_t z) { return z == 1; });
}

/// A picture that shows directions: each channel is a component.
Environment directions() {
  const std::uint32_t w = 2048, h = 1024;
  std::vector<float> rgb;
  for (std::uint32_t y = 0; y < h; ++y)
    for (std::uint32_t x = 0; x < w; ++x) {
      const double v = (y + 0.5) / h * std::numbers::pi, u = ((x + 0.5) / w - 0.5) * 2 * std::numbers::pi;
      for (const double c : {std::sin(v) * std::sin(u), std::cos(v), -std::sin(v) * std::cos(u)})
        rgb.push_back(float(c));
    }
  return Environment(std::move(rgb), w, h);
}

Vec3 light_along(const Caster& caster, const Lighting& lighting, const Environment& environment,
                 const Ray& ray) {
  Hit hit;
  REQUIRE(caster.first_hit(ray, hit));
  Rng rng(1);
  return Radiance(caster, lighting, environment, ray.direction).of_hit(ray, hit, rng);
}

}  // namespace

TEST_CASE("a white furnace: mirror and glass in an even environment return just that") {
  const TileMap tile = *make_tile(*parse_recipe("spheres:cells=6,resolution=24"));
  const CellObject object = *author_cell_object(make_sphere({0, 0, 0}, 1, 20), tile, {.grid = {.tiles = 5}});
  const auto caster = make_exact_caster(object);
  const Environment even(Vec3{0.25, 0.5, 2});
  for (const Lighting& lighting : {Lighting{.bounces = 1}, Lighting{.bounces = 7}, Lighting{.ior = 1.5},
                                   Lighting{.ior = 1.0}, Lighting{.ior = 2.4, .events = 40}}) {
    RenderOptions options{
        .width = 120, .height = 120, .lighting = lighting, .environment = &even, .samples = 2};
    const Result<RenderResult> r = render(*caster, options);
    REQUIRE(r.ok());
    CHECK(r->hits > 3000);
    for (std::size_t i = 0; i < r->depth.size(); ++i) {
      REQUIRE(std::abs(r->rgb[3 * i] - 0.25f) < 1e-5f);
      REQUIRE(std::abs(r->rgb[3 * i + 1] - 0.5f) < 1e-5f);
      REQUIRE(std::abs(r->rgb[3 * i + 2] - 2.0f) < 1e-5f);
    }
  }
}

TEST_CASE("Snell's law, the critical angle and reflection, in closed form") {
  const Vec3 up{0, 0, 1};
  for (const double angle : {0.0, 0.2, 0.7, 1.2, 1.5}) {
    const Vec3 d{std::sin(angle), 0, -std::cos(angle)};
    const auto in = refract(d, up, 1 / 1.5);
    REQUIRE(in);
    CHECK(in->x == Approx(std::sin(angle) / 1.5).margin(1e-15));
    CHECK(length(*in) == Approx(1));
    CHECK(reflect(d, up).z == Approx(-d.z));
    CHECK(reflect(d, up).x == Approx(d.x).margin(1e-15));
    // From the dense side all is reflected beyond asin(1 / 1.5).
    CHECK(refract(d, up, 1.5).has_value() == (std::sin(angle) * 1.5 <= 1));
  }
  const double critical = std::asin(1 / 1.5);
  CHECK(refract({std::sin(critical - 1e-9), 0, -std::cos(critical - 1e-9)}, up, 1.5));
  CHECK_FALSE(refract({std::sin(critical + 1e-9), 0, -std::cos(critical + 1e-9)}, up, 1.5));
}

TEST_CASE("a glass slab shifts a ray by Snell's law") {
  const CellObject object = slab();  // from z = 8 to 16
  const auto caster = make_exact_caster(object);
  for (const double angle : {0.1, 0.5, 0.9}) {
    const Ray ray{{30, 36.5, 30}, {std::sin(angle), 0, -std::cos(angle)}};
    Hit hit;
    REQUIRE(caster->first_hit(ray, hit));
    const Vec3 entry = ray.origin + ray.direction * hit.t;
    CHECK(entry.z == Approx(16));
    const Vec3 inner = *refract(ray.direction, caster->shading_normal(hit), 1 / 1.5);
    Hit exit;
    REQUIRE(caster->first_exit({entry - hit.face_normal * 1e-5, inner}, exit));
    const Vec3 out = entry + inner * exit.t;
    const double inside_angle = std::asin(std::sin(angle) / 1.5);
    CHECK(std::abs(out.x - entry.x - 8 * std::tan(inside_angle)) < 1e-4);
    CHECK(exit.face_normal == Vec3{0, 0, -1});
    CHECK(dot(caster->shading_normal(exit), Vec3{0, 0, -1}) == Approx(1));
    // And it goes on in the direction that it came in.
    const Vec3 seen = light_along(*caster, {.ior = 1.5}, directions(), ray);
    CHECK(length(seen - ray.direction) < 2e-3);
  }
}

TEST_CASE("in a glass block, total reflection turns a ray around") {
  // 24 wide, 40 high, from (8, 8, 8) to (32, 32, 48); all that happens is far from its edges.
  const CellObject object = make_blocks({5, 5, 7}, 8, [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x >= 1 && x <= 3 && y >= 1 && y <= 3 && z >= 1 && z <= 5;
  });
  const auto caster = make_exact_caster(object);
  const double angle = 0.6;
  const Vec3 d{std::sin(angle), 0, -std::cos(angle)};
  // Entering the top at x = 24, it is bent to asin(sin 0.6 / 1.5) = 0.386 from the vertical, meets the side x
  // = 32 at z = 28, 1.185 from its normal and so beyond the critical 0.730, is mirrored, and leaves below at
  // x = 23.9.
  const Vec3 seen = light_along(*caster, {.ior = 1.5}, directions(), {Vec3{24.2, 20.3, 48} - d * 5, d});
  CHECK(std::abs(seen.x + std::sin(angle)) < 3e-3);
  CHECK(std::abs(seen.z + std::cos(angle)) < 3e-3);
}

TEST_CASE("reflections between two facing walls go as computed by hand") {
  // Walls fill x < 8 and x >= 24; the gap between is 16 wide. Bouncing at 45° in x and z, a ray needs 16 of z
  // a hop.
  const CellObject object = make_blocks(
      {4, 3, 20}, 8, [](std::uint32_t x, std::uint32_t, std::uint32_t) { return x == 0 || x == 3; });
  const auto caster = make_exact_caster(object);
  const double s = std::sqrt(0.5);
  const Ray ray{{16, 12, 150},
                {s, 0, -s}};  // meets x = 24 at z = 142, x = 8 at 126, 24 at 110, …, the end at z = 0
  for (const std::uint32_t bounces : {1u, 2u, 5u, 50u}) {
    // Ten hits: 142, 126, 110, 94, 78, 62, 46, 30, 14, and no more before z = 0: nine.
    const std::uint32_t hits = std::min(bounces, 9u);
    const Vec3 expected{hits % 2 == 0 ? s : -s, 0, -s};
    const Vec3 seen = light_along(*caster, {.bounces = bounces}, directions(), ray);
    INFO(bounces << ": " << seen.x << " " << seen.y << " " << seen.z);
    CHECK(length(seen - expected) < 3e-3);
  }
}

TEST_CASE("hard shadow and ambient occlusion") {
  // A plate with a roof over half of it.
  const CellObject object = make_blocks({6, 6, 6}, 8, [](std::uint32_t x, std::uint32_t, std::uint32_t z) {
    return z == 0 || (z == 3 && x < 3);
  });
  const auto caster = make_exact_caster(object);
  const Environment sky(Vec3{1, 1, 1});
  const Ray open{{44.5, 20, 40}, {0, 0, -1}}, covered{{2, 20, 14}, {0, 0, -1}};
  const Lighting sun{.light = Vec3{0, 0, 1}};
  CHECK(light_along(*caster, sun, sky, open).x > 0.5);
  CHECK(light_along(*caster, sun, sky, covered).x < 0.15);
  // Slanted light reaches under the roof: from z = 8 the roof's edge, at x = 24 and z = 24, is seen at 45°
  // from x = 8.
  const Lighting low{.light = Vec3{1, 0, 1}};
  CHECK(light_along(*caster, low, sky, {{12, 20, 14}, {0, 0, -1}}).x > 0.3);
  CHECK(light_along(*caster, low, sky, {{4, 20, 14}, {0, 0, -1}}).x < 0.15);
  const Lighting ao{.occlusion_rays = 256}, none{};
  CHECK(light_along(*caster, ao, sky, {{44.5, 20, 40}, {0, 0, -1}}).x ==
        Approx(light_along(*caster, none, sky, open).x));
  // In a corner between floor and wall half of the sky is gone.
  const CellObject corner = make_blocks(
      {6, 6, 6}, 8, [](std::uint32_t x, std::uint32_t, std::uint32_t z) { return z == 0 || x == 0; });
  const auto in_corner = make_exact_caster(corner);
  const Ray edge{{8.5, 24, 30}, {0, 0, -1}}, far{{44.5, 24, 30}, {0, 0, -1}};
  const double near_wall = light_along(*in_corner, ao, sky, edge).x,
               away = light_along(*in_corner, none, sky, far).x;
  CHECK(near_wall < 0.75 * away);
  CHECK(near_wall > 0.2 * away);
}

TEST_CASE("a clip plane shows the inside, with its own normal") {
  const CellObject object = slab();
  const auto caster = make_exact_caster(object);
  const Vec3 n = normalize({0.3, 0.2, 1});
  const double d = dot(n, {36, 36, 12});  // through the middle of the slab
  const ClippedCaster clipped(*caster, n * 3, 3 * d);
  Hit hit;
  const Ray ray{{36, 36, 40}, {0, 0, -1}};
  REQUIRE(clipped.first_hit(ray, hit));
  CHECK(hit.t == Approx(28));
  CHECK(length(hit.face_normal - n) < 1e-12);
  CHECK(length(clipped.shading_normal(hit) - n) < 1e-12);
  CHECK_FALSE(clipped.inside({36, 36, 12.5}));
  CHECK(clipped.inside({36, 36, 11.5}));
  // From below the surface is met before the cut, and a ray that is past the cut before the object misses.
  REQUIRE(clipped.first_hit({{36, 36, 0}, {0, 0, 1}}, hit));
  CHECK(hit.t == Approx(8));
  CHECK_FALSE(clipped.first_hit({{36, 36, 40}, {0, 0, 1}}, hit));
  // From inside it leaves through the cut.
  REQUIRE(clipped.first_exit({{36, 36, 9}, {0, 0, 1}}, hit));
  CHECK(hit.t == Approx(3));
  CHECK(length(hit.face_normal - n) < 1e-12);
}

TEST_CASE("a clip plane that cuts nothing changes nothing, though faces are parallel to it") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  const CellObject object = *author_cell_object(make_sphere({0, 0, 0}, 1, 20), tile, {.grid = {.tiles = 6}});
  const auto caster = make_exact_caster(object);
  const ClippedCaster clipped(*caster, {0, 0, 1}, 5);
  RenderOptions options{.mode = RenderMode::kNormal, .width = 100, .height = 100};
  const Result<RenderResult> whole = render(*caster, options), cut = render(clipped, options);
  CHECK(whole->hits > 1000);
  CHECK(whole->depth == cut->depth);
  CHECK(whole->normal == cut->normal);
}

TEST_CASE("a ray leaves the object at the first voxel that is not inside, exactly") {
  Rng rng(8);
  const CellObject object = random_object(rng, "voronoi:cells=4,resolution=8,seed=1", {3, 3, 3}, 0.7);
  const auto caster = make_exact_caster(object), linear = make_linear_caster(object, 1.0 / 256);
  int begun = 0;
  for (int k = 0; k < 20000; ++k) {
    const Ray ray{{rng.below(24) + 0.5, rng.below(24) + 0.25, rng.uniform(0, 24)},
                  {double(rng.below(9)) - 4, double(rng.below(9)) - 4, rng.uniform(-4, 4)}};
    Hit hit;
    const Voxel start{std::int64_t(ray.origin.x), std::int64_t(ray.origin.y), std::int64_t(ray.origin.z)};
    const bool inside = is_inside(object, start);
    REQUIRE(caster->inside(ray.origin) == inside);
    REQUIRE(caster->first_exit(ray, hit) == inside);
    if (!inside) continue;
    ++begun;
    // Voxel by voxel, without any skip.
    WalkRay walk;
    REQUIRE(WalkRay::make(ray, walk));
    WalkPlace place;
    REQUIRE(enter_grid(walk, {24, 24, 24}, place));
    Voxel last{};
    const auto in = [&](const Voxel& v) {
      for (const std::int64_t c : v)
        if (c < 0 || c >= 24) return false;
      return is_inside(object, v);
    };
    while (in(place.voxel)) {
      const Voxel v = place.voxel;
      last = v;
      leave_box(walk, v, {v[0] + 1, v[1] + 1, v[2] + 1}, place);
    }
    REQUIRE(hit.t == Approx(place.t * walk.scale).epsilon(1e-12));
    REQUIRE(in(hit.element));
    REQUIRE(dot(hit.face_normal, ray.direction) > 0);
    // What linear search finds is never before, and mostly within a step of it.
    Hit late;
    REQUIRE(linear->first_exit(ray, late));
    REQUIRE(late.t >= hit.t - 1e-9);
  }
  CHECK(begun > 4000);
}

TEST_CASE("colors are the product of the tile's, the cell's and the instance's") {
  CellObject object =
      make_blocks({2, 1, 1}, 8, [](std::uint32_t, std::uint32_t, std::uint32_t) { return true; });
  object.color = ColorMap{{2, 1, 1}, {{255, 0, 255}, {255, 255, 0}}, 0};
  object.cell_colors = ColorList{{{255, 128, 255}}, 0};
  object.instance_colors = ColorList{{{255, 255, 255}, {0, 255, 255}}, 0};
  const auto caster = make_exact_caster(object);
  const auto at = [&](double x) {
    Hit hit;
    const Ray ray{{x, 4.5, 20}, {0, 0, -1}};
    REQUIRE(caster->first_hit(ray, hit));
    return caster->color(hit, ray.origin + ray.direction * hit.t);
  };
  const double half = std::pow((128 / 255.0 + 0.055) / 1.055, 2.4);
  CHECK(length(at(2.5) - Vec3{1, 0, 1}) < 1e-12);
  CHECK(length(at(6.5) - Vec3{1, half, 0}) < 1e-12);
  CHECK(length(at(10.5) - Vec3{0, 0, 1}) < 1e-12);
  CHECK(length(at(14.5) - Vec3{0, half, 0}) < 1e-12);
}

TEST_CASE("lighting out of range is a usage error") {
  const CellObject object = slab();
  const auto caster = make_exact_caster(object);
  for (const Lighting& bad : {Lighting{.bounces = 5000}, Lighting{.reflectivity = 2}, Lighting{.ior = 0.5},
                              Lighting{.light = Vec3{0, 0, 0}}, Lighting{.occlusion_rays = 100000}})
    CHECK(render(*caster, {.width = 8, .height = 8, .lighting = bad}).error().code == ErrorCode::kUsage);
  CHECK(render(*caster, {.width = 8, .height = 8, .samples = 0}).error().code == ErrorCode::kUsage);
}

TEST_CASE("an environment is seen where its directions say, without a seam") {
  const Environment picture = directions();
  for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}, Vec3{-1, 0, 0}, Vec3{0.3, -0.5, 0.8},
                       Vec3{-1e-4, 0, 1}, Vec3{1e-4, 0, 1}})
    CHECK(length(picture.radiance(d * 3) - normalize(d)) < 5e-3);
  const Environment sky = make_sky();
  CHECK(sky.radiance({0, 1, 0}).z > sky.radiance({0, -1, 0}).z);
  CHECK(sky.radiance({-0.5, 0.6, 0.62}).x > 5);
}
