#include "sdk/tiles/assemble.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

/// The first voxel of each code, in storage order.
std::vector<std::uint64_t> first_voxels(const Index3& resolution, const VoxelCodes& codes, std::size_t count,
                                        unsigned workers) {
  const std::uint64_t slice = std::uint64_t{resolution[0]} * resolution[1];
  std::vector<std::vector<std::uint64_t>> firsts(workers, std::vector<std::uint64_t>(count, kNever));
  parallel_for(resolution[2], workers, [&](std::size_t z, unsigned worker) {
    std::vector<std::uint64_t>& first = firsts[worker];
    for (std::uint64_t i = z * slice; i < (z + 1) * slice; ++i) {
      std::uint64_t& f = first[codes.get(i)];
      f = std::min(f, i);
    }
  });
  for (unsigned w = 1; w < workers; ++w)
    for (std::size_t c = 0; c < count; ++c) firsts[0][c] = std::min(firsts[0][c], firsts[w][c]);
  return std::move(firsts[0]);
}

}  // namespace

TileMap assemble_tile(const Index3& resolution, const VoxelCodes& codes, std::span<const CodeOwner> owners,
                      unsigned threads) {
  const std::uint64_t slice = std::uint64_t{resolution[0]} * resolution[1];
  const unsigned workers = std::min(resolve_threads(threads), resolution[2]);
  // Within a code all voxels are shifted alike, so its first voxel is also its first in the cell's own
  // coordinates.
  const std::vector<std::uint64_t> first = first_voxels(resolution, codes, owners.size() + 1, workers);

  TileMap tile;
  tile.resolution = resolution;
  std::vector<std::uint32_t> id_of_code(owners.size() + 1, 0);
  for (std::size_t begin = 0, end = 0; begin < owners.size(); begin = end) {
    // The cell's first voxel over all its images, by (z, y, x).
    using Place = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
    Place home_place;
    std::array<std::int32_t, 3> home{};
    bool any = false;
    for (end = begin; end < owners.size() && owners[end].cell == owners[begin].cell; ++end) {
      const std::uint64_t f = first[end + 1];
      if (f == kNever) continue;
      const auto& s = owners[end].shift;
      const Place place{std::int64_t(f / slice) - s[2] * std::int64_t{resolution[2]},
                        std::int64_t(f % slice / resolution[0]) - s[1] * std::int64_t{resolution[1]},
                        std::int64_t(f % resolution[0]) - s[0] * std::int64_t{resolution[0]}};
      if (!any || place < home_place) {
        home_place = place;
        home = s;
      }
      any = true;
    }
    if (!any) continue;
    ++tile.cell_count;
    // Owners ascend by shift, and a piece's home differs from it by a constant: pieces are sorted.
    for (std::size_t k = begin; k < end; ++k) {
      if (first[k + 1] == kNever) continue;
      Piece piece{std::uint16_t(tile.cell_count), {}};
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int32_t offset = owners[k].shift[a] - home[a];
        assert(offset >= -128 && offset <= 127);
        piece.home[a] = std::int8_t(offset);
      }
      tile.pieces.push_back(piece);
      id_of_code[k + 1] = std::uint32_t(tile.pieces.size());
    }
  }
  assert(tile.cell_count > 0);

  tile.id_bytes = TileMap::id_bytes_for(tile.pieces.size());
  tile.voxel_ids.resize(tile.voxel_count() * tile.id_bytes);
  parallel_for(resolution[2], workers, [&](std::size_t z, unsigned) {
    for (std::uint64_t i = z * slice; i < (z + 1) * slice; ++i) {
      const std::uint32_t id = id_of_code[codes.get(i)];
      for (std::uint32_t b = 0; b < tile.id_bytes; ++b)
        tile.voxel_ids[i * tile.id_bytes + b] = std::uint8_t(id >> (8 * b));
    }
  });
  return tile;
}

}  // namespace mesocell
