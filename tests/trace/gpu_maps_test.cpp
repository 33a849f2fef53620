#include "sdk/trace/gpu_maps.h"

#include <set>

#include "sdk/core/rng.h"
#include "sdk/tiles/tile_builder.h"
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

TEST_CASE("source algorithm 4.5: index 64 addresses a fifth channel; ours count from zero") {
  // 64 cells of a voxel each, so 64 pieces, every third of them INSIDE.
  TileBuilder builder({4, 4, 4}, 64);
  for (std::uint32_t i = 0; i < 64; ++i) builder.set(i, builder.code(i + 1, builder.image_index(0, 0, 0)));
  CellObject o;
  o.tile = builder.finish(1, nullptr);
  o.grid = {{0, 0, 0}, 1, {1, 1, 1}};
  o.membership = {MembershipRule::kCentre, {1, 1, 1}, 64, {MembershipMap::kFirstBlock}, {}};
  o.membership.blocks.resize(16);
  const auto expected = [](std::uint32_t index) {
    return index % 3 == 1 ? GpuMaps::kInside : GpuMaps::kOutside;
  };
  for (std::uint32_t c = 1; c <= 64; ++c)
    o.membership.blocks[(c - 1) / 4] |= std::uint8_t(expected(c) << (2 * ((c - 1) % 4)));
  const Result<GpuMaps> maps = make_gpu_maps(o);
  REQUIRE(maps.ok());
  // Algorithm 4.5 as printed: channel = index >> 4, shift = (index & 15) << 1, of indices 1 to 64.
  const auto channel = [](std::uint32_t index) { return index >> 4; };
  const auto by_source = [&](std::uint32_t index) {
    return maps->tile_codes[0][channel(index)] >> ((index & 15) << 1) & 3;
  };
  CHECK(channel(64) == maps->tile_codes[0].size());
  std::uint32_t wrong = 0;
  for (std::uint32_t index = 1; index < 64; ++index) wrong += by_source(index) != expected(index);
  CHECK(wrong > 30);
  for (std::uint32_t index = 1; index <= 64; ++index) REQUIRE(maps->code(0, index) == expected(index));
  // The last one is at the top of the last channel.
  CHECK(maps->tile_codes[0][3] >> 30 == std::uint32_t(GpuMaps::kInside));

  // Cells that hold fewer than eight pieces each leave room for more than eight cells.
  Rng rng(3);
  const CellObject spheres = random_object(rng, "spheres:cells=16,resolution=16,seed=2", {3, 3, 3}, 0.5);
  CHECK(8 * spheres.tile.cell_count > 64);
  REQUIRE(spheres.tile.pieces.size() <= 64);
  REQUIRE(make_gpu_maps(spheres).ok());
}
