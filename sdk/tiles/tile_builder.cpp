#include "sdk/tiles/tile_builder.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

struct CodedPiece {
  std::uint32_t code;
  Piece piece;
};

}  // namespace

TileBuilder::TileBuilder(Index3 resolution, std::uint32_t cells, std::int32_t reach)
    : resolution_(resolution),
      cells_(cells),
      reach_(reach),
      images_(std::uint32_t((2 * reach + 1) * (2 * reach + 1) * (2 * reach + 1))) {
  assert(cells >= 1 && cells <= 0xffff);
  const std::uint64_t codes = std::uint64_t{cells} * images_;
  code_bytes_ = TileMap::id_bytes_for(codes);
  codes_.resize(std::uint64_t{resolution[0]} * resolution[1] * resolution[2] * code_bytes_);
}

std::uint32_t TileBuilder::get(std::uint64_t i) const {
  std::uint32_t v = 0;
  for (std::uint32_t b = 0; b < code_bytes_; ++b) v |= std::uint32_t{codes_[i * code_bytes_ + b]} << (8 * b);
  return v;
}

TileMap TileBuilder::finish(unsigned threads, TileReport* report) {
  const std::uint64_t slice = std::uint64_t{resolution_[0]} * resolution_[1];
  const std::size_t codes = std::size_t{cells_} * images_ + 1;

  // The first voxel of each code, in storage order. Within a code all voxels are shifted alike, so its first
  // voxel is also its first in the instance's own coordinates.
  const unsigned workers = std::min(resolve_threads(threads), resolution_[2]);
  std::vector<std::vector<std::uint64_t>> firsts(workers, std::vector<std::uint64_t>(codes, kNever));
  parallel_for(resolution_[2], workers, [&](std::size_t z, unsigned worker) {
    std::vector<std::uint64_t>& first = firsts[worker];
    for (std::uint64_t i = z * slice; i < (z + 1) * slice; ++i) {
      std::uint64_t& f = first[get(i)];
      f = std::min(f, i);
    }
  });
  std::vector<std::uint64_t>& first = firsts[0];
  for (unsigned w = 1; w < workers; ++w)
    for (std::size_t c = 0; c < codes; ++c) first[c] = std::min(first[c], firsts[w][c]);

  TileMap tile;
  tile.resolution = resolution_;
  std::vector<CodedPiece> coded;
  for (std::uint32_t cell = 1; cell <= cells_; ++cell) {
    // The instance whose seed is in tile 0: its first voxel over all images, by (z, y, x).
    using Place = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
    Place home_place;
    std::array<std::int32_t, 3> home_shift{};
    bool any = false;
    for (std::uint32_t image = 0; image < images_; ++image) {
      const std::uint64_t f = first[code(cell, image)];
      if (f == kNever) continue;
      const auto s = image_shift(image);
      const Place place{std::int64_t(f / slice) - s[2] * std::int64_t{resolution_[2]},
                        std::int64_t(f % slice / resolution_[0]) - s[1] * std::int64_t{resolution_[1]},
                        std::int64_t(f % resolution_[0]) - s[0] * std::int64_t{resolution_[0]}};
      if (!any || place < home_place) {
        home_place = place;
        home_shift = s;
      }
      any = true;
    }
    if (!any) continue;
    ++tile.cell_count;
    for (std::uint32_t image = 0; image < images_; ++image) {
      if (first[code(cell, image)] == kNever) continue;
      const auto s = image_shift(image);
      CodedPiece p{code(cell, image), {std::uint16_t(tile.cell_count), {}}};
      for (std::size_t a = 0; a < 3; ++a) p.piece.home[a] = std::int8_t(s[a] - home_shift[a]);
      coded.push_back(p);
    }
  }
  assert(tile.cell_count > 0);
  if (report) report->dropped_cells = cells_ - tile.cell_count;

  // Images of one cell are visited by (s_z, s_y, s_x), and home differs from s by a constant: already sorted.
  std::vector<std::uint32_t> id_of_code(codes, 0);
  for (std::size_t k = 0; k < coded.size(); ++k) {
    tile.pieces.push_back(coded[k].piece);
    id_of_code[coded[k].code] = std::uint32_t(k + 1);
  }
  tile.id_bytes = TileMap::id_bytes_for(tile.pieces.size());
  tile.voxel_ids.resize(tile.voxel_count() * tile.id_bytes);
  parallel_for(resolution_[2], workers, [&](std::size_t z, unsigned) {
    for (std::uint64_t i = z * slice; i < (z + 1) * slice; ++i) {
      const std::uint32_t id = id_of_code[get(i)];
      for (std::uint32_t b = 0; b < tile.id_bytes; ++b)
        tile.voxel_ids[i * tile.id_bytes + b] = std::uint8_t(id >> (8 * b));
    }
  });
  codes_ = {};
  return tile;
}

}  // namespace mesocell
