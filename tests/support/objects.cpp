#include "tests/support/objects.h"

#include "sdk/tiles/tile_spec.h"

namespace mesocell::test {

CellObject random_object(Rng& rng, const std::string& recipe, const Index3& tiles, double inside_share) {
  CellObject o;
  o.tile = std::move(*make_tile(*parse_recipe(recipe)));
  o.grid = {{0, 0, 0}, 1, tiles};
  o.membership.tiles = tiles;
  o.membership.cell_count = o.tile.cell_count;
  const std::size_t bytes = o.membership.block_bytes();
  std::uint32_t blocks = 0;
  for (std::uint32_t z = 0; z < tiles[2]; ++z)
    for (std::uint32_t y = 0; y < tiles[1]; ++y)
      for (std::uint32_t x = 0; x < tiles[0]; ++x) {
        // A third of the tiles is empty, so that there is something to skip.
        if (rng.below(3) == 0) {
          o.membership.entries.push_back(std::uint32_t(Tag::kOutside));
          continue;
        }
        o.membership.entries.push_back(MembershipMap::kFirstBlock + blocks++);
        o.membership.blocks.resize(blocks * bytes);
        for (const Piece& p : o.tile.pieces) {
          if (p.home != std::array<std::int8_t, 3>{0, 0, 0}) continue;  // one look at each cell
          bool leaves = false;
          for (const Piece& q : o.tile.pieces) {
            const std::int64_t at[3] = {std::int64_t(x) - q.home[0], std::int64_t(y) - q.home[1],
                                        std::int64_t(z) - q.home[2]};
            for (std::size_t a = 0; a < 3; ++a)
              leaves = leaves || (q.cell == p.cell && (at[a] < 0 || at[a] >= tiles[a]));
          }
          const Tag tag = !leaves && rng.uniform() < inside_share ? Tag::kInside
                          : rng.below(2) == 0                     ? Tag::kOutside
                                                                  : Tag::kIntersected;
          o.membership.blocks[(blocks - 1) * bytes + (p.cell - 1u) / 4] |=
              std::uint8_t(std::uint32_t(tag) << (2 * ((p.cell - 1) % 4)));
        }
      }
  return o;
}

CellObject make_blocks(const Index3& tiles, std::uint32_t edge,
                       const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t)>& inside) {
  CellObject o;
  o.tile.resolution = {edge, edge, edge};
  o.tile.cell_count = 1;
  o.tile.pieces = {{1, {}}};
  o.tile.voxel_ids.assign(o.tile.voxel_count(), 1);
  o.grid = {{0, 0, 0}, 1, tiles};
  o.membership.tiles = tiles;
  o.membership.cell_count = 1;
  for (std::uint32_t z = 0; z < tiles[2]; ++z)
    for (std::uint32_t y = 0; y < tiles[1]; ++y)
      for (std::uint32_t x = 0; x < tiles[0]; ++x)
        o.membership.entries.push_back(std::uint32_t(inside(x, y, z) ? Tag::kInside : Tag::kOutside));
  return o;
}

}  // namespace mesocell::test
