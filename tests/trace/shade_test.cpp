#include <cmath>
#include <limits>

#include "sdk/author/cell_object.h"
#include "sdk/shade/render.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/exact.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

CellObject ball() {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  Result<CellObject> object =
      author_cell_object(make_sphere({0, 0, 0}, 1, 40), tile, {.grid = {.tiles = 16}});
  REQUIRE(object.ok());
  return std::move(*object);
}

}  // namespace

TEST_CASE("the camera is right-handed and frames the box") {
  const Box3 box{{-1, -2, -3}, {1, 2, 3}};
  const Camera camera =
      *Camera::make(box, {.eye = Vec3{0, 0, 10}, .look = Vec3{0, 0, 0}, .fov_degrees = 90}, 200, 100);
  const Ray centre = camera.ray(100, 50);
  CHECK(centre.direction.z == Approx(-1));
  CHECK(camera.ray(150, 50).direction.x > 0);
  CHECK(camera.ray(100, 25).direction.y > 0);
  // 90° vertically: the top edge is at 45°.
  const Ray top = camera.ray(100, 0);
  CHECK(top.direction.y == Approx(-top.direction.z));
  CHECK(length(top.direction) == Approx(1));

  const Camera framed = *Camera::make(box, {}, 640, 480);
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner{k & 1 ? 1.0 : -1.0, k & 2 ? 2.0 : -2.0, k & 4 ? 3.0 : -3.0};
    const Vec3 v = normalize(corner - framed.eye());
    const double half = std::tan(35 * 3.14159265358979 / 360);
    const Vec3 right = normalize(cross(framed.forward(), {0, 1, 0})), up = cross(right, framed.forward());
    const double forward = dot(v, framed.forward());
    CHECK(std::abs(dot(v, up)) / forward < half);
    CHECK(std::abs(dot(v, right)) / forward < half * 640 / 480);
  }
}

TEST_CASE("a camera that sees nothing is a usage error") {
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  CHECK(Camera::make(box, {.eye = Vec3{1, 1, 1}, .look = Vec3{1, 1, 1}}, 10, 10).error().code ==
        ErrorCode::kUsage);
  CHECK_FALSE(
      Camera::make(box, {.eye = Vec3{0, 9, 0}, .look = Vec3{0, 0, 0}, .up = Vec3{0, 1, 0}}, 10, 10).ok());
  CHECK(Camera::make(box, {.eye = Vec3{0, 9, 0}, .look = Vec3{0, 0, 0}}, 10, 10).ok());
  CHECK_FALSE(Camera::make(box, {.fov_degrees = 0}, 10, 10).ok());
  CHECK_FALSE(Camera::make(box, {.fov_degrees = 180}, 10, 10).ok());
}

TEST_CASE("a rendered ball has the right silhouette and depth") {
  const CellObject object = ball();
  const auto caster = make_exact_caster(object);
  RenderOptions options{.mode = RenderMode::kDepth, .width = 160, .height = 160};
  options.camera = {.eye = Vec3{0, 0, 5}, .look = Vec3{0, 0, 0}, .fov_degrees = 30};
  const Result<RenderResult> r = render(*caster, options);
  REQUIRE(r.ok());
  CHECK(r->rays == 160 * 160);
  const Camera camera = *Camera::make(caster->object_box(), options.camera, 160, 160);
  // Cells have an edge of about a sixteenth of the ball's diameter; what fits inside misses at most two of
  // them.
  const double cell = 2.0 / 16 * 2;
  // A voxel whose centre is inside can reach beyond the ball by half its diagonal.
  const double outer = 1 + 0.87 * object.grid.voxel_edge;
  std::uint64_t hits = 0;
  for (std::uint32_t y = 0; y < 160; ++y)
    for (std::uint32_t x = 0; x < 160; ++x) {
      const float depth = r->depth[x + 160 * y];
      const Ray ray = camera.ray(x + 0.5, y + 0.5);
      const double b = dot(ray.origin, ray.direction), nearest2 = dot(ray.origin, ray.origin) - b * b;
      hits += std::isfinite(depth);
      if (nearest2 > outer * outer) CHECK(depth == std::numeric_limits<float>::infinity());
      if (nearest2 < (1 - cell) * (1 - cell)) {
        const double surface = -b - std::sqrt(outer * outer - nearest2);
        const double inner = -b - std::sqrt((1 - cell) * (1 - cell) - nearest2);
        CHECK(depth >= surface - 1e-6);
        CHECK(depth <= inner + 1e-6);
      }
    }
  CHECK(r->hits == hits);
}

TEST_CASE("shading normals of a ball of spheres point outward, and pictures do not depend on threads") {
  const CellObject object = ball();
  const auto caster = make_exact_caster(object);
  RenderOptions options{.width = 100, .height = 80, .threads = 1};
  const Result<RenderResult> one = render(*caster, options);
  options.threads = 3;
  const Result<RenderResult> three = render(*caster, options);
  CHECK(one->rgb == three->rgb);
  CHECK(one->depth == three->depth);
  const Camera camera = *Camera::make(caster->object_box(), options.camera, 100, 80);
  int seen = 0;
  for (int k = 0; k < 8000; ++k) {
    Hit hit;
    const Ray ray = camera.ray(k % 100 + 0.5, k / 100 + 0.5);
    if (!caster->first_hit(ray, hit)) continue;
    const Vec3 n = caster->shading_normal(hit);
    CHECK(length(n) == Approx(1));
    seen += dot(n, ray.direction) < 0.2;
    CHECK(dot(n, hit.face_normal) > -0.7);
  }
  CHECK(double(seen) > 0.98 * double(one->hits));
}

TEST_CASE("modes are chosen by name") {
  CHECK(*parse_render_mode("first-hit") == RenderMode::kFirstHit);
  CHECK(*parse_render_mode("depth") == RenderMode::kDepth);
  CHECK(*parse_render_mode("cell") == RenderMode::kCell);
  CHECK(*parse_render_mode("normal") == RenderMode::kNormal);
  CHECK(*parse_render_mode("color") == RenderMode::kColor);
  CHECK(parse_render_mode("colour").error().code == ErrorCode::kUsage);
}

TEST_CASE("rendering can be cancelled") {
  const CellObject object = ball();
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  CHECK(render(*make_exact_caster(object), {}, &progress).error().code == ErrorCode::kCancelled);
}
