#include "converters/vdb/assemble_object.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "converters/vdb/volume_lookup.h"
#include "sdk/tiles/assemble.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kMaxTileVoxels = std::uint64_t{1} << 28;
constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{1} << 30;

Error contradiction(const char* what) {
  return {ErrorCode::kInvalidInput,
          std::string("the volume's grids are no asset (") + what + "); export it again"};
}

/// An image of a cell in the tile, in the order of pieces.
using PieceKey = std::tuple<std::uint32_t, int, int, int>;  ///< cell, home z, y, x

Result<PieceKey> piece_at(const VolumeLookup& cells, const VolumeLookup& homes, const VoxelCoord& at,
                          std::uint32_t cell_count) {
  const double cell = cells.value(at);
  if (!(cell >= 0 && cell <= cell_count)) return contradiction("a cell beyond their number");
  if (cell == 0) return PieceKey{};
  const VolumeValue home = homes.numbers(at);
  for (const double h : home)
    if (!(h >= -128 && h <= 127)) return contradiction("a home too far away");
  return PieceKey{std::uint32_t(cell), int(home[2]), int(home[1]), int(home[0])};
}

Result<TileMap> restore_tile(const SparseVolume& tile, const SparseVolume& home, const ObjectLayout& layout,
                             unsigned threads, const Progress* progress) {
  const Index3& n = layout.resolution;
  const std::uint64_t voxels = std::uint64_t{n[0]} * n[1] * n[2];
  if (voxels > kMaxTileVoxels) return Error{ErrorCode::kLimit, "its tile has more than 2^28 voxels"};
  const VolumeLookup cells(tile), homes(home);
  std::map<PieceKey, std::uint32_t> codes;
  const auto each = [&](auto visit) -> Status {
    VoxelCoord at;
    std::uint64_t i = 0;
    for (at[2] = 0; at[2] < std::int32_t(n[2]); ++at[2]) {
      if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "interrupted"};
      for (at[1] = 0; at[1] < std::int32_t(n[1]); ++at[1])
        for (at[0] = 0; at[0] < std::int32_t(n[0]); ++at[0], ++i) {
          const Result<PieceKey> piece = piece_at(cells, homes, at, layout.cells);
          if (!piece) return piece.error();
          if (std::get<0>(*piece) != 0) visit(i, *piece);
        }
    }
    return {};
  };
  if (Status s = each([&](std::uint64_t, const PieceKey& piece) { codes.try_emplace(piece); }); !s)
    return s.error();
  if (codes.empty()) return contradiction("an empty tile");
  std::vector<CodeOwner> owners;
  std::array<std::int32_t, 3> low{}, high{};  // of the shifts of a cell
  for (auto& [piece, code] : codes) {
    const auto [cell, z, y, x] = piece;
    const std::array<std::int32_t, 3> shift{x, y, z};
    const std::uint32_t last = owners.empty() ? 0 : owners.back().cell;
    if (cell > last + 1) return contradiction("a cell without voxels");
    if (cell != last) low = high = shift;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], shift[a]);
      high[a] = std::max(high[a], shift[a]);
      if (high[a] - low[a] >= 128) return contradiction("a home too far away");
    }
    owners.push_back({cell, shift});
    code = std::uint32_t(owners.size());
  }
  if (owners.back().cell != layout.cells) return contradiction("a cell without voxels");
  VoxelCodes voxel_codes(voxels, owners.size());
  if (Status s = each([&](std::uint64_t i, const PieceKey& piece) { voxel_codes.set(i, codes.at(piece)); });
      !s)
    return s.error();
  TileMap made = assemble_tile(n, voxel_codes, owners, threads);
  // It finds the homes itself; these must be the ones that the file has.
  if (made.pieces.size() != owners.size()) return contradiction("homes that are none");
  for (std::size_t k = 0; k < owners.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a)
      if (made.pieces[k].cell != owners[k].cell || made.pieces[k].home[a] != owners[k].shift[a])
        return contradiction("homes that are none");
  return made;
}

/// A voxel of each cell, [c - 1], that is in its home tile.
std::vector<VoxelCoord> home_voxels(const TileMap& tile) {
  std::vector<VoxelCoord> voxels(tile.cell_count, VoxelCoord{-1, -1, -1});
  const Index3& n = tile.resolution;
  std::uint64_t i = 0;
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t y = 0; y < n[1]; ++y)
      for (std::uint32_t x = 0; x < n[0]; ++x, ++i) {
        const std::uint32_t id = tile.id(i);
        if (id == 0) continue;
        const Piece& piece = tile.pieces[id - 1];
        if (piece.home != std::array<std::int8_t, 3>{} || voxels[piece.cell - 1][0] >= 0) continue;
        voxels[piece.cell - 1] = {std::int32_t(x), std::int32_t(y), std::int32_t(z)};
      }
  return voxels;
}

Result<MembershipMap> restore_tags(const SparseVolume& volume, const TileMap& tile,
                                   const ObjectLayout& layout, const Progress* progress) {
  const VolumeLookup tags(volume);
  const std::vector<VoxelCoord> voxels = home_voxels(tile);
  MembershipMap map;
  map.rule = layout.rule;
  map.tiles = layout.grid.tiles;
  map.cell_count = tile.cell_count;
  map.entries.reserve(layout.grid.tile_count());
  std::vector<std::uint8_t> found(tile.cell_count);
  std::uint32_t blocks = 0;
  const std::array<std::int32_t, 3> n{std::int32_t(tile.resolution[0]), std::int32_t(tile.resolution[1]),
                                      std::int32_t(tile.resolution[2])};
  VoxelCoord t;
  for (t[2] = 0; t[2] < std::int32_t(map.tiles[2]); ++t[2])
    for (t[1] = 0; t[1] < std::int32_t(map.tiles[1]); ++t[1]) {
      if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "interrupted"};
      for (t[0] = 0; t[0] < std::int32_t(map.tiles[0]); ++t[0]) {
        const VoxelCoord low{t[0] * n[0], t[1] * n[1], t[2] * n[2]};
        // Most tiles are empty: their voxels need not be looked at.
        const VolumeLookup::Range range =
            tags.range(low, {low[0] + n[0] - 1, low[1] + n[1] - 1, low[2] + n[2] - 1}, {0, 2});
        if (range.low == 0 && range.high == 0) {
          map.entries.push_back(std::uint32_t(Tag::kOutside));
          continue;
        }
        bool same = true;
        for (std::uint32_t c = 0; c < tile.cell_count; ++c) {
          const VoxelCoord& v = voxels[c];
          const double tag = tags.value({low[0] + v[0], low[1] + v[1], low[2] + v[2]});
          if (tag != 0 && tag != 1 && tag != 2) return contradiction("a tag that is none");
          found[c] = std::uint8_t(tag);
          same = same && found[c] == found[0];
        }
        if (same) {
          map.entries.push_back(found[0]);
          continue;
        }
        map.entries.push_back(MembershipMap::kFirstBlock + blocks++);
        const std::size_t at = map.blocks.size();
        if (at + map.block_bytes() > kMaxBlockBytes)
          return Error{ErrorCode::kLimit, "its tags take more than 1 GiB"};
        map.blocks.resize(at + map.block_bytes());
        for (std::uint32_t c = 0; c < tile.cell_count; ++c)
          map.blocks[at + c / 4] |= std::uint8_t(std::uint32_t(found[c]) << (2 * (c % 4)));
      }
    }
  return map;
}

}  // namespace

Result<CellObject> assemble_object(const SparseVolume& tile, const SparseVolume& home,
                                   const SparseVolume& membership, unsigned threads,
                                   const Progress* progress) {
  if (tile.type != VolumeType::kInt || membership.type != VolumeType::kInt || home.type != VolumeType::kInt3)
    return contradiction("types of their values");
  const Result<ObjectLayout> layout = parse_object_metadata(tile.metadata);
  if (!layout) return layout.error();
  for (std::size_t a = 0; a < 3; ++a)
    if (std::uint64_t{layout->grid.tiles[a]} * layout->resolution[a] >= std::uint64_t{SparseVolume::kReach})
      return contradiction("more voxels along an axis than a volume has");
  Result<TileMap> map = restore_tile(tile, home, *layout, threads, progress);
  if (!map) return map.error();
  Result<MembershipMap> tags = restore_tags(membership, *map, *layout, progress);
  if (!tags) return tags.error();
  CellObject object;
  object.grid = layout->grid;
  object.tile = std::move(*map);
  object.membership = std::move(*tags);
  return object;
}

}  // namespace mesocell
