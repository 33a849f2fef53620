#include "converters/bench/scene.h"

#include <algorithm>
#include <string>

#include "sdk/core/shapes.h"
#include "sdk/membership/diagnose.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

CellObject scene(const std::string& text) {
  const Result<SceneName> name = parse_scene_name(text);
  REQUIRE(name.ok());
  CHECK(name->text() == text);
  Result<CellObject> object = make_scene(*name, 0, {});
  REQUIRE(object.ok());
  return std::move(*object);
}

}  // namespace

TEST_CASE("shapes are closed meshes within the cube") {
  CHECK(shapes().size() == 10);
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    const TriangleMesh mesh = shape.make(1);
    CHECK(diagnose(mesh).closed());
    CHECK(signed_volume(mesh) > 0);
    const Box3 box = bounding_box(mesh);
    for (std::size_t a = 0; a < 3; ++a) {
      CHECK(box.min[a] > -0.5);
      CHECK(box.max[a] < 0.5);
    }
    const Vec3 extent = box.extent();
    CHECK(std::max({extent.x, extent.y, extent.z}) > 0.85);
  }
}

TEST_CASE("the wavy sphere is the one of its formula") {
  const TriangleMesh mesh = find_shape("wavy")->make(1);
  CHECK(mesh.triangles.size() >= 200000);
  for (std::size_t k = 0; k < mesh.vertices.size(); k += 97) {
    const Vec3 v = mesh.vertices[k];
    const double left =
        length(v) + 0.04 * 0.45 * std::sin(8.19 * v.x) * std::sin(10.24 * v.y) * std::sin(12.29 * v.z);
    CHECK(std::abs(left - 0.45) < 1e-12);
  }
}

TEST_CASE("a recipe of a shape says how large and how fine it is") {
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    const auto mesh = make_shape(*parse_recipe(std::string(shape.name) + ":size=3"));
    REQUIRE(mesh);
    const Vec3 extent = bounding_box(*mesh).extent();
    CHECK(std::max({extent.x, extent.y, extent.z}) == Approx(3).epsilon(1e-12));
  }
  const auto coarse = make_shape(*parse_recipe("sphere")),
             fine = make_shape(*parse_recipe("sphere:detail=2"));
  REQUIRE((coarse && fine));
  CHECK(fine->triangles.size() == 4 * coarse->triangles.size());
  CHECK(signed_volume(*fine) == Approx(0.5235987755982988).epsilon(1e-3));
  CHECK(diagnose(*fine).closed());
  for (const char* text : {"dodo", "sphere:size=0", "sphere:detail=17", "torus:hole=1"})
    CHECK(make_shape(*parse_recipe(text)).error().code == ErrorCode::kUsage);
}

TEST_CASE("every shape goes with every tile, in a grid that is the cube") {
  CHECK(bench_tiles().size() == 4);
  for (const Shape& shape : shapes())
    for (const BenchTile& tile : bench_tiles()) {
      if (shape.name != "sponge" && tile.name != "worley") continue;
      const CellObject object = scene(std::string(shape.name) + "-" + std::string(tile.name) + "-16x8");
      INFO(shape.name << " " << tile.name);
      CHECK(object.grid.tiles == Index3{16, 16, 16});
      CHECK(object.tile.resolution == Index3{8, 8, 8});
      CHECK(object.grid.box_min == std::array<double, 3>{-0.5, -0.5, -0.5});
      CHECK(object.box_max() == std::array<double, 3>{0.5, 0.5, 0.5});
      CHECK(count_instances(object.membership).inside > 300);
    }
}

TEST_CASE("the reference scene has as many instances inside as its volume holds") {
  const CellObject object = scene("wavy-voronoi-64x32");
  const InstanceCounts counts = count_instances(object.membership);
  CHECK(counts.inside + counts.outside + counts.intersected == 8u * 64 * 64 * 64);
  CHECK(counts.inside == 772165);
}

TEST_CASE("names that are no scene are told what there is") {
  for (const char* bad :
       {"", "wavy", "wavy-voronoi", "wavy-voronoi-64", "wavy-voronoi-64x", "wavy-voronoi-x32",
        "cube-voronoi-64x32", "wavy-foam-64x32", "wavy-voronoi-3x32", "wavy-voronoi-64x257",
        "wavy-voronoi-64x32 ", "wavy-voronoi--64x32", "wavy-voronoi-64x32x32"}) {
    INFO(bad);
    const Result<SceneName> name = parse_scene_name(bad);
    REQUIRE_FALSE(name.ok());
    CHECK(name.error().code == ErrorCode::kUsage);
    for (const char* word : {"wavy", "sponge", "voronoi", "ellipsoids", "64x32"})
      CHECK(name.error().message.find(word) != std::string::npos);
  }
}
