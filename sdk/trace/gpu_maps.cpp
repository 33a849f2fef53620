#include "sdk/trace/gpu_maps.h"

#include <string>

namespace mesocell {
namespace {

constexpr std::size_t kMaxSplitCells = 64;

/// Tag of the instance that piece `p` of tile `t` belongs to. One at home outside the grid leaves the grid,
/// so it is never INSIDE; whether the surface cuts it no tag tells, and OUTSIDE is drawn alike.
Tag tag_of(const CellObject& o, const Piece& p, const std::array<std::int64_t, 3>& t) {
  std::array<std::uint32_t, 3> home{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t h = t[a] + p.home[a];
    if (h < 0 || h >= o.grid.tiles[a]) return Tag::kOutside;
    home[a] = std::uint32_t(h);
  }
  return o.membership.tag(o.grid.tile_index(home[0], home[1], home[2]), p.cell);
}

}  // namespace

Result<GpuMaps> make_gpu_maps(const CellObject& object) {
  const TileMap& tile = object.tile;
  if (tile.pieces.size() > kMaxSplitCells)
    return Error{ErrorCode::kLimit, "the tile's cells are cut into " + std::to_string(tile.pieces.size()) +
                                        " pieces by its border, and 128 bits hold 64; use fewer cells"};
  GpuMaps maps;
  maps.resolution = tile.resolution;
  maps.face_codes.resize(tile.pieces.size());
  for (const Piece& p : tile.pieces) maps.cells.push_back(p.cell);
  maps.split_cells.reserve(tile.voxel_count());
  const Index3& n = tile.resolution;
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t y = 0; y < n[1]; ++y)
      for (std::uint32_t x = 0; x < n[0]; ++x) {
        const std::uint32_t id = tile.id(tile.voxel_index(x, y, z));
        maps.split_cells.push_back(std::uint8_t(id));
        if (id == 0) continue;
        const unsigned faces = (x == 0) | (x + 1 == n[0]) << 1 | (y == 0) << 2 | (y + 1 == n[1]) << 3 |
                               (z == 0) << 4 | (z + 1 == n[2]) << 5;
        maps.face_codes[id - 1] |= std::uint8_t(faces);
      }

  maps.tiles = object.grid.tiles;
  maps.tile_codes.reserve(object.grid.tile_count());
  std::array<std::int64_t, 3> t{};
  for (t[2] = 0; t[2] < maps.tiles[2]; ++t[2])
    for (t[1] = 0; t[1] < maps.tiles[1]; ++t[1])
      for (t[0] = 0; t[0] < maps.tiles[0]; ++t[0]) {
        std::array<std::uint32_t, 4> code{};
        for (std::size_t k = 0; k < kMaxSplitCells; ++k) {
          const std::uint32_t bits = k < tile.pieces.size() ? std::uint32_t(tag_of(object, tile.pieces[k], t))
                                                            : std::uint32_t(GpuMaps::kUnset);
          code[k / 16] |= bits << (2 * (k % 16));
        }
        maps.tile_codes.push_back(code);
      }
  return maps;
}

}  // namespace mesocell
