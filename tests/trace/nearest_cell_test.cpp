#include "sdk/trace/nearest_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// The closed boxes of all INSIDE voxels, in voxels.
std::vector<Box3> inside_voxels(const CellObject& o) {
  std::vector<Box3> boxes;
  Voxel v{}, size{};
  for (std::size_t a = 0; a < 3; ++a) size[a] = std::int64_t{o.grid.tiles[a]} * o.tile.resolution[a];
  for (v[2] = 0; v[2] < size[2]; ++v[2])
    for (v[1] = 0; v[1] < size[1]; ++v[1])
      for (v[0] = 0; v[0] < size[0]; ++v[0])
        if (is_inside(o, v)) {
          const Vec3 low{double(v[0]), double(v[1]), double(v[2])};
          boxes.push_back({low, low + Vec3{1, 1, 1}});
        }
  return boxes;
}

}  // namespace

TEST_CASE("distances from cells are those of a search through all inside voxels") {
  Rng rng(1);
  const std::string recipes[] = {"voronoi:cells=3,resolution=6,seed=1", "voronoi:cells=1,resolution=4,seed=2",
                                 "spheres:cells=4,resolution=8,seed=3", "bricks:resolution=8,mortar=0.2"};
  int zeros = 0, objects = 0;
  for (const std::string& recipe : recipes)
    for (const Index3 tiles : {Index3{3, 2, 4}, Index3{9, 3, 1}, Index3{5, 5, 5}})
      for (const double share : {0.02, 0.5, 1.0}) {
        CellObject object = random_object(rng, recipe, tiles, share);
        const std::vector<Box3> voxels = inside_voxels(object);
        // All of these are exact in double precision.
        const double edge = 0.25;
        const Vec3 corner{100, -50, 3};
        object.grid.voxel_edge = edge;
        object.grid.box_min = to_array(corner);
        const Result<NearestCell> nearest = NearestCell::make(object);
        if (voxels.empty()) {
          CHECK(nearest.error().code == ErrorCode::kInvalidInput);
          continue;
        }
        ++objects;
        REQUIRE(nearest.ok());
        for (int k = 0; k < 100; ++k) {
          // On corners, edges, faces and centres of voxels too; within the grid, near it and far from it.
          const double reach = k % 10 == 0 ? 1000 : 4;
          Vec3 q;
          for (std::size_t a = 0; a < 3; ++a)
            q[a] = std::floor(rng.uniform(-reach, tiles[a] * object.tile.resolution[a] + reach) * 8) / 8;
          if (k % 2 == 0) q = {std::floor(q.x), std::floor(q.y), q.z};
          double least = std::numeric_limits<double>::infinity();
          for (const Box3& voxel : voxels) least = std::min(least, squared_distance(voxel, q));
          zeros += least == 0;
          CHECK(nearest->distance(corner + q * edge) == std::sqrt(least) * edge);
        }
      }
  CHECK(objects > 25);
  CHECK(zeros > 200);
}

TEST_CASE("points of any coordinates have distances of their precision, from any number of threads") {
  Rng rng(2);
  CellObject object = random_object(rng, "voronoi:cells=4,resolution=8,seed=5", {4, 6, 5}, 0.3);
  const std::vector<Box3> voxels = inside_voxels(object);
  object.grid.voxel_edge = 0.001;
  object.grid.box_min = {1e3, -1e3, 0};
  const Result<NearestCell> nearest = NearestCell::make(object, 3);
  REQUIRE(nearest.ok());
  std::vector<Vec3> points(500);
  for (Vec3& p : points)
    for (std::size_t a = 0; a < 3; ++a) p[a] = object.grid.box_min[a] + rng.uniform(-0.01, 0.06);
  std::vector<double> found(points.size());
  parallel_for(points.size(), 4, [&](std::size_t k, unsigned) { found[k] = nearest->distance(points[k]); });
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 q = (points[k] - to_vec3(object.grid.box_min)) / object.grid.voxel_edge;
    double least = std::numeric_limits<double>::infinity();
    for (const Box3& voxel : voxels) least = std::min(least, squared_distance(voxel, q));
    CHECK(found[k] == Approx(std::sqrt(least) * 0.001).margin(1e-12));
    CHECK(found[k] == nearest->distance(points[k]));
  }
}

TEST_CASE("a tile of too many runs is over a limit") {
  CellObject object;
  object.tile.resolution = {512, 512, 128};
  object.tile.cell_count = 2;
  object.tile.pieces = {{1, {}}, {2, {}}};
  for (std::uint64_t i = 0; i < object.tile.voxel_count(); ++i) object.tile.voxel_ids.push_back(1 + i % 2);
  object.grid = {{0, 0, 0}, 1, {1, 1, 1}};
  object.membership.tiles = {1, 1, 1};
  object.membership.cell_count = 2;
  object.membership.entries = {std::uint32_t(Tag::kInside)};
  const Result<NearestCell> nearest = NearestCell::make(object);
  REQUIRE_FALSE(nearest.ok());
  CHECK(nearest.error().code == ErrorCode::kLimit);
}
