#pragma once

#include <cstdint>
#include <functional>

#include "format/cell_object.h"

namespace mesocell::test {

/// An object of any voxels: tiles of 4³ cells of one voxel each, one metre a voxel, the corner at the origin,
/// INSIDE where `inside` says, which is given the voxel's place.
[[nodiscard]] inline CellObject make_voxels(
    const Index3& tiles, const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t)>& inside) {
  CellObject o;
  o.tile.resolution = {4, 4, 4};
  o.tile.cell_count = 64;
  for (std::uint8_t k = 1; k <= 64; ++k) {
    o.tile.pieces.push_back({k, {}});
    o.tile.voxel_ids.push_back(k);
  }
  o.grid = {{0, 0, 0}, 1, tiles};
  o.membership.tiles = tiles;
  o.membership.cell_count = 64;
  std::uint32_t blocks = 0;
  for (std::uint32_t z = 0; z < tiles[2]; ++z)
    for (std::uint32_t y = 0; y < tiles[1]; ++y)
      for (std::uint32_t x = 0; x < tiles[0]; ++x) {
        std::uint32_t count = 0;
        std::uint8_t tags[16] = {};
        for (std::uint32_t k = 0; k < 64; ++k)
          if (inside(4 * x + k % 4, 4 * y + k / 4 % 4, 4 * z + k / 16)) {
            tags[k / 4] = std::uint8_t(tags[k / 4] | 1u << (2 * (k % 4)));
            ++count;
          }
        if (count == 0 || count == 64) {
          o.membership.entries.push_back(std::uint32_t(count ? Tag::kInside : Tag::kOutside));
          continue;
        }
        o.membership.entries.push_back(MembershipMap::kFirstBlock + blocks++);
        o.membership.blocks.insert(o.membership.blocks.end(), tags, tags + 16);
      }
  return o;
}

}  // namespace mesocell::test
