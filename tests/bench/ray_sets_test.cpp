#include "converters/bench/ray_sets.h"

#include <algorithm>
#include <cmath>

#include "converters/bench/scene.h"
#include "converters/bench/views.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

constexpr std::uint32_t kWidth = 60, kHeight = 44;

std::unique_ptr<Caster> caster_of(const char* scene) {
  const Result<SceneName> name = parse_scene_name(scene);
  REQUIRE(name.ok());
  const Result<CellObject> object = make_scene(*name, 0, {});
  REQUIRE(object.ok());
  return std::move(*make_cell_object_caster(*object, "exact"));
}

Camera camera_of(const Caster& exact, const char* name, double tile_edge = 1.0 / 16) {
  const Result<BenchView> view = parse_view(name);
  REQUIRE(view.ok());
  const Result<PlacedView> placed = make_view(*view, exact, tile_edge, kWidth, kHeight);
  INFO(name << ": " << (placed ? "" : placed.error().message));
  REQUIRE(placed.ok());
  return placed->camera;
}

std::vector<Ray> rays_of(RaySet set, const Caster& exact, const Camera& camera, std::uint64_t seed = 1,
                         unsigned threads = 0) {
  return make_rays(set, exact, camera, kWidth, kHeight, seed, threads, {});
}

std::size_t count_hits(const Caster& exact, const std::vector<Ray>& rays) {
  std::vector<StreamHit> hits(rays.size());
  exact.first_hits(rays, hits);
  return std::size_t(std::ranges::count_if(hits, [](const StreamHit& h) { return h.hit(); }));
}

bool same(const std::vector<Ray>& a, const std::vector<Ray>& b) {
  return std::ranges::equal(
      a, b, [](const Ray& p, const Ray& q) { return p.origin == q.origin && p.direction == q.direction; });
}

}  // namespace

TEST_CASE("primary rays are those of all pixels, in squares of eight") {
  const auto exact = caster_of("wavy-voronoi-16x8");
  const Camera camera = camera_of(*exact, "full");
  const std::vector<Ray> rays = rays_of(RaySet::kPrimary, *exact, camera);
  REQUIRE(rays.size() == kWidth * kHeight);
  CHECK(rays[0].direction == camera.ray(0.5, 0.5).direction);
  CHECK(rays[9].direction == camera.ray(1.5, 1.5).direction);
  CHECK(rays[64].direction == camera.ray(8.5, 0.5).direction);
  // The picture's last column of squares is four pixels wide, its last row four high.
  CHECK(rays[8 * kWidth - 1].direction == camera.ray(59.5, 7.5).direction);
  CHECK(rays.back().direction == camera.ray(59.5, 43.5).direction);
}

TEST_CASE("rays that follow a hit start before its face and leave it") {
  const auto exact = caster_of("torus-bricks-16x8");
  const Camera camera = camera_of(*exact, "full");
  const std::size_t hits = count_hits(*exact, rays_of(RaySet::kPrimary, *exact, camera));
  for (const RaySet set : {RaySet::kDiffuse, RaySet::kReflection, RaySet::kShadow}) {
    const std::vector<Ray> rays = rays_of(set, *exact, camera);
    INFO(ray_set_name(set));
    if (set == RaySet::kShadow)
      CHECK(rays.size() < hits);
    else
      CHECK(rays.size() == hits);
    CHECK(rays.size() > hits / 4);
    for (const Ray& ray : rays) {
      CHECK(std::abs(length(ray.direction) - 1) < 1e-12);
      CHECK_FALSE(exact->inside(ray.origin));
      if (set == RaySet::kShadow) {
        const Vec3 to = Vec3{1.5, 2, -1.2} - ray.origin;
        CHECK(length(cross(normalize(to), ray.direction)) < 1e-12);
      }
    }
    const std::size_t again = count_hits(*exact, rays);
    CHECK(again > 0);
    CHECK(again < rays.size());
  }
}

TEST_CASE("the same seed gives the same rays, whatever the threads") {
  const auto exact = caster_of("torus-bricks-16x8");
  const Camera camera = camera_of(*exact, "full");
  const std::vector<Ray> rays = rays_of(RaySet::kDiffuse, *exact, camera, 7, 1);
  CHECK(same(rays, rays_of(RaySet::kDiffuse, *exact, camera, 7, 3)));
  CHECK_FALSE(same(rays, rays_of(RaySet::kDiffuse, *exact, camera, 8, 1)));
  CHECK(
      same(rays_of(RaySet::kReflection, *exact, camera, 7), rays_of(RaySet::kReflection, *exact, camera, 8)));
}

TEST_CASE("cameras see what their names say") {
  const auto exact = caster_of("wavy-voronoi-16x8");
  const auto cover = [&](const char* name) {
    const std::vector<Ray> rays = rays_of(RaySet::kPrimary, *exact, camera_of(*exact, name));
    return double(count_hits(*exact, rays)) / double(rays.size());
  };
  CHECK(camera_of(*exact, "full").eye() == Vec3{0, 0, -1.1});
  CHECK(std::abs(cover("full") - 0.57) < 0.03);
  CHECK(std::abs(cover("cover90") - 0.9) < 0.05);
  CHECK(cover("close") > 0.9);
  CHECK(cover("inside") > 0.5);
  CHECK_FALSE(exact->inside(camera_of(*exact, "inside").eye()));
  for (const char* view : {"close", "grazing", "grazing-1", "grazing-45", "grazing-90"}) {
    INFO(view);
    CHECK(cover(view) > 0.3);
    CHECK_FALSE(exact->inside(camera_of(*exact, view).eye()));
  }
}

TEST_CASE("grazing cameras meet a plate at their angle") {
  const auto exact = caster_of("slab-voronoi-32x16");
  for (const double degrees : {5.0, 20.0, 45.0}) {
    // The plate stands upright, but for its hills.
    const BenchView view{"grazing", degrees};
    const Result<PlacedView> placed = make_view(view, *exact, 1.0 / 32, kWidth, kHeight);
    REQUIRE(placed.ok());
    REQUIRE(placed->plane.has_value());
    CHECK(std::abs(std::asin(-dot(*placed->plane, placed->camera.forward())) * 180 / 3.14159265358979 -
                   degrees) < 1e-9);
    const double sine = std::abs(placed->camera.forward().z);
    CHECK(std::abs(std::asin(sine) * 180 / 3.14159265358979 - degrees) < 12);
  }
}

TEST_CASE("names that are no camera or ray set are refused") {
  for (const char* bad : {"", "fulll", "grazing-", "grazing-0", "grazing-91", "grazing-x", "grazing-5x"}) {
    const Result<BenchView> view = parse_view(bad);
    REQUIRE_FALSE(view.ok());
    CHECK(view.error().code == ErrorCode::kUsage);
    CHECK(view.error().message.find("cover90") != std::string::npos);
  }
  CHECK(find_ray_set("shadow") == RaySet::kShadow);
  CHECK_FALSE(find_ray_set("caustic").has_value());
}
