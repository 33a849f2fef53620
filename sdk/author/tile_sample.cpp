#include "sdk/author/tile_sample.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mesocell {

CellObject make_tile_sample(TileMap tile) {
  // A piece lies in the home tile minus its offset.
  std::array<std::int32_t, 3> before{}, after{};
  for (const Piece& piece : tile.pieces)
    for (std::size_t a = 0; a < 3; ++a) {
      before[a] = std::max(before[a], std::int32_t{piece.home[a]});
      after[a] = std::max(after[a], -std::int32_t{piece.home[a]});
    }
  CellObject object;
  object.grid.voxel_edge = 1.0 / std::max({tile.resolution[0], tile.resolution[1], tile.resolution[2]});
  for (std::size_t a = 0; a < 3; ++a) {
    object.grid.tiles[a] = std::uint32_t(before[a] + 1 + after[a]);
    // Not by negation, which would make a zero negative.
    object.grid.box_min[a] = 0 - double(before[a]) * tile.resolution[a] * object.grid.voxel_edge;
  }
  MembershipMap& membership = object.membership;
  membership.tiles = object.grid.tiles;
  membership.cell_count = tile.cell_count;
  membership.entries.assign(object.grid.tile_count(), std::uint32_t(Tag::kOutside));
  membership.entries[object.grid.tile_index(std::uint32_t(before[0]), std::uint32_t(before[1]),
                                            std::uint32_t(before[2]))] = std::uint32_t(Tag::kInside);
  object.tile = std::move(tile);
  return object;
}

}  // namespace mesocell
