#include "sdk/surface/surface_colors.h"

#include <atomic>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/core/srgb.h"
#include "sdk/surface/color.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Whether a voxel, of the grid or not, is of an INSIDE instance.
bool solid(const CellObject& object, const Voxel& v) {
  for (std::size_t a = 0; a < 3; ++a)
    if (v[a] < 0 || v[a] >= std::int64_t{object.grid.tiles[a]} * object.tile.resolution[a]) return false;
  return is_inside(object, v);
}

/// Of each tile and color voxel with a color the centres of the surface's faces there, in voxels, in order of
/// voxels and then of faces: by looking at every voxel of the grid.
std::map<std::pair<std::uint64_t, std::size_t>, std::vector<Vec3>> faces_by_definition(
    const CellObject& object, const Index3& resolution) {
  const Index3& n = object.tile.resolution;
  const Index3& tiles = object.grid.tiles;
  const auto tile_is_inside = [&](std::int64_t tx, std::int64_t ty, std::int64_t tz) {
    for (std::int64_t z = tz * n[2]; z < (tz + 1) * n[2]; ++z)
      for (std::int64_t y = ty * n[1]; y < (ty + 1) * n[1]; ++y)
        for (std::int64_t x = tx * n[0]; x < (tx + 1) * n[0]; ++x) {
          const std::uint64_t i =
              object.tile.voxel_index(std::uint32_t((x + n[0]) % n[0]), std::uint32_t((y + n[1]) % n[1]),
                                      std::uint32_t((z + n[2]) % n[2]));
          if (object.tile.id(i) != 0 && !solid(object, {x, y, z})) return false;
        }
    return true;
  };
  std::map<std::pair<std::uint64_t, std::size_t>, std::vector<Vec3>> out;
  for (std::int64_t tz = 0; tz < tiles[2]; ++tz)
    for (std::int64_t ty = 0; ty < tiles[1]; ++ty)
      for (std::int64_t tx = 0; tx < tiles[0]; ++tx) {
        bool buried = true;
        for (int k = 0; k < 27 && buried; ++k)
          buried = tile_is_inside(tx + k % 3 - 1, ty + k / 3 % 3 - 1, tz + k / 9 - 1);
        if (buried) continue;
        for (std::int64_t z = 0; z < n[2]; ++z)
          for (std::int64_t y = 0; y < n[1]; ++y)
            for (std::int64_t x = 0; x < n[0]; ++x) {
              const Voxel v{tx * n[0] + x, ty * n[1] + y, tz * n[2] + z};
              if (!solid(object, v)) continue;
              for (std::size_t face = 0; face < 6; ++face) {
                Voxel next = v;
                next[face / 2] += face % 2 ? 1 : -1;
                if (solid(object, next)) continue;
                Vec3 centre;
                std::array<std::size_t, 3> c{};
                for (std::size_t a = 0; a < 3; ++a) {
                  centre[a] = double(v[a]) + (a != face / 2 ? 0.5 : face % 2 ? 1.0 : 0.0);
                  const double share = (double(v[a] % n[a]) + 0.5) / n[a];
                  c[a] = std::size_t(std::floor(share * resolution[a] + 1e-9));
                }
                const std::uint64_t tile =
                    object.grid.tile_index(std::uint32_t(tx), std::uint32_t(ty), std::uint32_t(tz));
                out[{tile, c[0] + resolution[0] * (c[1] + resolution[1] * c[2])}].push_back(centre);
              }
            }
      }
  return out;
}

/// Every bit of it a function of the place.
Vec3 place_color(Vec3 p) {
  Vec3 color;
  for (std::size_t a = 0; a < 3; ++a) color[a] = 0.5 + 0.5 * std::sin(0.7 * p[a] + 0.3 * p[(a + 1) % 3]);
  return color;
}

SurfaceColors bake(const CellObject& object, const Index3& resolution,
                   const ColorField& field = place_color) {
  auto made = make_surface_colors(object, field, resolution, 2);
  REQUIRE(made.ok());
  REQUIRE(made->has_value());
  return std::move(**made);
}

/// Bakes an object and compares the places and the colors with the definition.
void check_by_definition(const CellObject& object, const Index3& wanted) {
  const SurfaceColors map = bake(object, wanted);
  for (std::size_t a = 0; a < 3; ++a)
    REQUIRE(map.resolution[a] == std::min(wanted[a], object.tile.resolution[a]));
  const auto faces = faces_by_definition(object, map.resolution);
  REQUIRE(map.entries.size() == object.grid.tile_count());
  std::size_t found = 0;
  for (std::uint64_t tile = 0; tile < map.entries.size(); ++tile)
    for (std::size_t v = 0; v < map.voxels_per_brick(); ++v) {
      const Rgb8* const color = map.find(tile, v);
      const auto there = faces.find({tile, v});
      REQUIRE((color != nullptr) == (there != faces.end()));
      if (!color) continue;
      ++found;
      Vec3 sum;
      const std::size_t count = there->second.size(), samples = std::min<std::size_t>(count, 8);
      for (std::size_t k = 0; k < samples; ++k)
        sum = sum + place_color(
                        there->second[std::size_t(double(2 * k + 1) * double(count) / double(2 * samples))]);
      const Rgb8 expected = linear_to_srgb8(sum / double(samples));
      for (std::size_t a = 0; a < 3; ++a) REQUIRE(std::abs(int((*color)[a]) - int(expected[a])) <= 1);
    }
  CHECK(found == faces.size());
  CHECK(found == map.colors.size());
  CHECK(found > 100);
}

CellObject author_object(const TriangleMesh& mesh, const char* tile, std::uint32_t tiles) {
  Result<CellObject> object =
      author_cell_object(mesh, *make_tile(*parse_recipe(tile)), {.grid = {.tiles = tiles}});
  REQUIRE(object.ok());
  return std::move(*object);
}

}  // namespace

TEST_CASE("colors of the surface are where the voxels have it") {
  const TriangleMesh torus = make_torus({0, 0, 0}, 2, 0.8, 40, 24);
  check_by_definition(author_object(torus, "voronoi:cells=6,resolution=12,seed=5", 7), {4, 4, 4});
  check_by_definition(author_object(torus, "ellipsoids:cells=5,resolution=10,seed=2", 6), {3, 7, 32});
  check_by_definition(author_object(torus, "bricks:resolution=8", 8), {1, 8, 5});
}

TEST_CASE("random objects have colors of the surface where their voxels have it") {
  Rng rng(11);
  for (const char* recipe : {"voronoi:cells=3,resolution=5,seed=1", "voronoi:cells=9,resolution=7,seed=2",
                             "ellipsoids:cells=4,resolution=8,seed=3", "bricks:resolution=6"})
    for (const double share : {0.3, 0.97}) {
      const CellObject object = random_object(rng, recipe, {4, 5, 3}, share);
      check_by_definition(object, {1 + std::uint32_t(rng.below(5)), 3, 1 + std::uint32_t(rng.below(8))});
    }
}

TEST_CASE("tiles within a solid have no colors of the surface") {
  const CellObject object =
      make_blocks({5, 5, 5}, 8, [](std::uint32_t, std::uint32_t, std::uint32_t) { return true; });
  const SurfaceColors map = bake(object, {8, 8, 8});
  CHECK(map.first.size() == 125 - 27);
  CHECK(map.colors.size() == 40 * 40 * 40 - 38 * 38 * 38);
  CHECK(map.entries[object.grid.tile_index(2, 2, 2)] == SurfaceColors::kNoBrick);
}

TEST_CASE("colors of the surface stand for those of instances, where a ray hits them") {
  CellObject object =
      make_blocks({2, 1, 1}, 8, [](std::uint32_t, std::uint32_t, std::uint32_t) { return true; });
  object.cell_colors = ColorList{{{255, 0, 255}}, 0};
  object.instance_colors = ColorList{{{0, 0, 255}, {255, 255, 0}}, 0};
  object.surface_colors = bake(object, {4, 4, 4}, [](Vec3 p) {
    return p.x < 8 ? Vec3{p.x > 4 ? 1.0 : 0.0, 1, 0} : Vec3{1, 1, 1};
  });
  // The first color voxels of the second tile have none.
  SurfaceColors& map = *object.surface_colors;
  const std::uint32_t brick = map.entries[1];
  for (std::size_t v = 0; v < map.voxels_per_brick(); ++v)
    if (v % 4 == 0 && map.find(1, v)) {
      map.colors.erase(map.colors.begin() + (map.find(1, v) - map.colors.data()));
      map.masks[brick * map.mask_bytes() + v / 8] &= std::uint8_t(~(1u << v % 8));
    }
  for (const char* method : {"exact", "linear:1/64", "lod:1px"}) {
    const auto caster = make_cell_object_caster(object, method);
    REQUIRE(caster.ok());
    const auto at = [&](double x) {
      Hit hit;
      const Ray ray{{x, 4.5, 20}, {0, 0, -1}};
      REQUIRE((*caster)->first_hit(ray, hit));
      return (*caster)->color(hit, ray.origin + ray.direction * hit.t);
    };
    CHECK(length(at(1.5) - Vec3{0, 0, 0}) < 1e-12);
    CHECK(length(at(6.5) - Vec3{1, 0, 0}) < 1e-12);
    CHECK(length(at(8.5) - Vec3{1, 0, 0}) < 1e-12);   // the instance's, by that of the cell
    CHECK(length(at(14.5) - Vec3{1, 0, 1}) < 1e-12);  // the surface's, by that of the cell
  }
}

TEST_CASE("colors of the surface depend on neither threads nor the place of the object") {
  TriangleMesh torus = make_torus({0, 0, 0}, 2, 0.8, 40, 24);
  Rng rng(3);
  for (std::size_t v = 0; v < torus.vertices.size(); ++v)
    torus.colors.push_back({std::uint8_t(rng.below(256)), std::uint8_t(rng.below(256)), std::uint8_t(v)});
  const auto baked = [](const TriangleMesh& mesh, unsigned threads) {
    CellObject object = author_object(mesh, "voronoi:cells=6,resolution=12,seed=5", 8);
    Colors colors;
    colors.field = [&](const CellObject& o, unsigned t, const Progress*) {
      static const SurfacePaint kNoPaint;
      return make_mesh_color_field(o.grid, mesh, kNoPaint, t);
    };
    colors.surface_resolution = Index3{6, 6, 6};
    REQUIRE(apply_colors(std::move(colors), object, threads));
    REQUIRE(object.surface_colors.has_value());
    REQUIRE(object.instance_colors.has_value());
    return std::move(*object.surface_colors);
  };
  const SurfaceColors one = baked(torus, 1);
  CHECK(baked(torus, 3) == one);
  TriangleMesh scaled = torus;
  for (Vec3& v : scaled.vertices) v = v * 1024.0;
  CHECK(baked(scaled, 2) == one);
}

TEST_CASE("what cannot be baked is an error") {
  const CellObject object =
      author_object(make_torus({0, 0, 0}, 2, 0.8, 40, 24), "voronoi:cells=6,resolution=12,seed=5", 6);
  CHECK(make_surface_colors(object, place_color, {0, 4, 4}).error().code == ErrorCode::kUsage);
  CHECK(make_surface_colors(object, place_color, {4, 4, 33}).error().code == ErrorCode::kUsage);
  std::atomic<bool> cancel = true;
  Progress progress;
  progress.cancel = &cancel;
  CHECK(make_surface_colors(object, place_color, {4, 4, 4}, 2, &progress).error().code ==
        ErrorCode::kCancelled);
  CellObject nothing = object;
  nothing.membership.entries.assign(nothing.membership.entries.size(), 0);
  nothing.membership.blocks.clear();
  const auto none = make_surface_colors(nothing, place_color, {4, 4, 4});
  REQUIRE(none.ok());
  CHECK_FALSE(none->has_value());
}
