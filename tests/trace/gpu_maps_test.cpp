#include "sdk/trace/gpu_maps.h"

#include <set>

#include "sdk/core/rng.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

TEST_CASE("a GPU's two look-ups tell of every voxel what the maps say") {
  Rng rng(1);
  for (const char* recipe : {"voronoi:cells=8,resolution=12", "voronoi:cells=1,resolution=8",
                             "spheres:cells=7,resolution=10x12x9"}) {
    const CellObject object = random_object(rng, recipe, {3, 2, 4}, 0.5);
    const Result<GpuMaps> maps = make_gpu_maps(object);
    REQUIRE(maps.ok());
    REQUIRE(maps->tile_codes.size() == 24);
    const Index3& n = object.tile.resolution;
    std::uint64_t inside = 0;
    for (std::uint32_t z = 0; z < n[2] * 4; ++z)
      for (std::uint32_t y = 0; y < n[1] * 2; ++y)
        for (std::uint32_t x = 0; x < n[0] * 3; ++x) {
          const std::uint32_t split =
              maps->split_cells[object.tile.voxel_index(x % n[0], y % n[1], z % n[2])];
          const std::uint64_t tile = object.grid.tile_index(x / n[0], y / n[1], z / n[2]);
          const bool found = split != 0 && maps->code(tile, split) == GpuMaps::kInside;
          REQUIRE(found == is_inside(object, {x, y, z}));
          inside += found;
        }
    CHECK(inside > 0);
    // Slots that the tile does not use are unset, so a shader that strays is seen.
    for (std::uint32_t k = std::uint32_t(object.tile.pieces.size()) + 1; k <= 64; ++k)
      REQUIRE(maps->code(0, k) == GpuMaps::kUnset);
  }
}

TEST_CASE("face codes tell which faces a split cell touches, also opposite ones") {
  // One cell along x through the whole tile: it touches both faces, which the source's shift of 3 cannot say.
  CellObject o;
  o.tile.resolution = {4, 4, 4};
  o.tile.cell_count = 1;
  o.tile.pieces = {{1, {0, 0, 0}}};
  o.tile.voxel_ids.assign(64, 0);
  for (std::uint32_t x = 0; x < 4; ++x) o.tile.voxel_ids[o.tile.voxel_index(x, 0, 2)] = 1;
  o.grid = {{0, 0, 0}, 1, {1, 1, 1}};
  o.membership = {MembershipRule::kCentre, {1, 1, 1}, 1, {std::uint32_t(Tag::kIntersected)}, {}};
  const Result<GpuMaps> maps = make_gpu_maps(o);
  REQUIRE(maps.ok());
  CHECK(maps->face_codes == std::vector<std::uint8_t>{0b000111});
  CHECK(maps->code(0, 1) == GpuMaps::kIntersected);
  CHECK(maps->tile_codes[0][3] == 0xffffffffu);
}

TEST_CASE("a tile of too many pieces is refused, with their number") {
  Rng rng(2);
  const CellObject object = random_object(rng, "voronoi:cells=60,resolution=16", {2, 2, 2}, 0.5);
  REQUIRE(object.tile.pieces.size() > 64);
  const Result<GpuMaps> maps = make_gpu_maps(object);
  REQUIRE_FALSE(maps.ok());
  CHECK(maps.error().code == ErrorCode::kLimit);
  CHECK(maps.error().message.find(std::to_string(object.tile.pieces.size())) != std::string::npos);
}
