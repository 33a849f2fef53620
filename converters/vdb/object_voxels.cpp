#include "converters/vdb/object_voxels.h"

namespace mesocell {

ObjectVoxels::ObjectVoxels(const CellObject& object) : object_(object) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t resolution = object.tile.resolution[a];
    size_[a] = std::int32_t(object.grid.tiles[a] * resolution);
    places_[a].reserve(std::size_t(size_[a]));
    for (std::uint32_t t = 0; t < object.grid.tiles[a]; ++t)
      for (std::uint32_t v = 0; v < resolution; ++v) places_[a].push_back({t, v});
  }
}

bool ObjectVoxels::fits(const CellObject& object) {
  // With room for what surrounds it.
  constexpr std::uint64_t kMost = SparseVolume::kReach - 16;
  for (std::size_t a = 0; a < 3; ++a)
    if (std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a] > kMost) return false;
  return true;
}

std::vector<ObjectVoxels::Found> ObjectVoxels::pieces_of(const Index3& tile) const {
  std::vector<Found> pieces(object_.tile.pieces.size() + 1);
  for (std::size_t k = 0; k < object_.tile.pieces.size(); ++k) {
    const Piece& piece = object_.tile.pieces[k];
    Found& found = pieces[k + 1];
    found.cell = piece.cell;
    Index3 home{};
    bool in_grid = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t at = std::int64_t{tile[a]} + piece.home[a];
      in_grid = in_grid && at >= 0 && at < object_.grid.tiles[a];
      home[a] = std::uint32_t(at);
    }
    if (!in_grid) continue;
    found.home = object_.grid.tile_index(home[0], home[1], home[2]);
    found.tag = object_.membership.tag(found.home, piece.cell);
  }
  return pieces;
}

ObjectVoxels::Found ObjectVoxels::Reader::at(const VoxelCoord& voxel) {
  const ObjectVoxels& v = voxels_;
  std::array<const Place*, 3> place{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (voxel[a] < 0 || voxel[a] >= v.size_[a]) return {};
    place[a] = &v.places_[a][std::size_t(voxel[a])];
  }
  const std::uint64_t tile = v.object_.grid.tile_index(place[0]->tile, place[1]->tile, place[2]->tile);
  if (tile != last_tile_) {
    constexpr std::size_t kMostKnown = 4096;
    if (known_.size() >= kMostKnown) known_.clear();
    const auto [at, is_new] = known_.try_emplace(tile);
    if (is_new) at->second = v.pieces_of({place[0]->tile, place[1]->tile, place[2]->tile});
    last_tile_ = tile;
    last_ = &at->second;
  }
  const TileMap& map = v.object_.tile;
  return (*last_)[map.id(map.voxel_index(place[0]->in_tile, place[1]->in_tile, place[2]->in_tile))];
}

}  // namespace mesocell
