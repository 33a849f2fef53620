#include <algorithm>
#include <limits>
#include <string>

#include "sdk/core/parallel.h"
#include "sdk/surface/explicit_surface.h"
#include "sdk/surface/inside_tiles.h"
#include "sdk/surface/tile_contacts.h"
#include "sdk/surface/voxel_mesher.h"

namespace mesocell {
namespace {

/// The voxels of each cell, by the place of its home tile.
struct CellVoxels {
  std::vector<std::uint64_t> begin;  ///< of each cell's part of `voxels`; one more than cells
  std::vector<std::uint32_t> voxels;
  std::vector<LatticePoint> low, high;  ///< of each cell, in voxels from its home
};

class CellSorter {
 public:
  explicit CellSorter(const TileMap& tile) : tile_(tile) {}

  /// Calls body(voxel index, cell, place from home) for all that is not empty.
  template <typename Body>
  void each(const Body& body) const {
    std::uint32_t index = 0;
    for (std::uint32_t z = 0; z < tile_.resolution[2]; ++z)
      for (std::uint32_t y = 0; y < tile_.resolution[1]; ++y)
        for (std::uint32_t x = 0; x < tile_.resolution[0]; ++x, ++index)
          if (const std::uint32_t id = tile_.id(index))
            body(index, tile_.pieces[id - 1].cell - 1u, place(index, id));
  }

  [[nodiscard]] LatticePoint place(std::uint32_t index, std::uint32_t id) const {
    const Index3& r = tile_.resolution;
    const LatticePoint v{std::int32_t(index % r[0]), std::int32_t(index / r[0] % r[1]),
                         std::int32_t(index / r[0] / r[1])};
    const Piece& piece = tile_.pieces[id - 1];
    return {v[0] - piece.home[0] * std::int32_t(r[0]), v[1] - piece.home[1] * std::int32_t(r[1]),
            v[2] - piece.home[2] * std::int32_t(r[2])};
  }

  [[nodiscard]] CellVoxels sort() const {
    constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max();
    CellVoxels out;
    out.begin.assign(tile_.cell_count + std::size_t{2}, 0);
    out.low.assign(tile_.cell_count, {kFar, kFar, kFar});
    out.high.assign(tile_.cell_count, {-kFar, -kFar, -kFar});
    each([&](std::uint32_t, std::uint32_t cell, const LatticePoint& v) {
      ++out.begin[cell + std::size_t{2}];
      for (std::size_t a = 0; a < 3; ++a) {
        out.low[cell][a] = std::min(out.low[cell][a], v[a]);
        out.high[cell][a] = std::max(out.high[cell][a], v[a] + 1);
      }
    });
    for (std::size_t k = 2; k < out.begin.size(); ++k) out.begin[k] += out.begin[k - 1];
    out.voxels.resize(out.begin.back());
    // The place of the next one of cell c is at begin[c + 1], which so becomes the end of its part.
    each([&](std::uint32_t index, std::uint32_t cell, const LatticePoint&) {
      out.voxels[out.begin[cell + std::size_t{1}]++] = index;
    });
    return out;
  }

 private:
  const TileMap& tile_;
};

Error too_much(std::uint64_t max_bytes) {
  return Error{ErrorCode::kLimit, "a mesh of each cell would take more than " +
                                      std::to_string(max_bytes >> 20) +
                                      " MiB; allow more, or take fewer voxels"};
}

ExplicitSurface mesh_box(const PaddedVoxels& box, const LatticePoint& base) {
  ExplicitSurface surface;
  VoxelMesher().mesh(
      box,
      [&](const LatticePoint& p, unsigned fans) {
        const auto first = std::uint32_t(surface.vertices.size());
        surface.vertices.insert(surface.vertices.end(), fans,
                                {base[0] + p[0], base[1] + p[1], base[2] + p[2]});
        surface.split_vertices += fans - 1;
        return first;
      },
      [&](const std::array<std::uint32_t, 4>& corners, std::size_t) { surface.squares.push_back(corners); });
  return surface;
}

}  // namespace

Result<std::vector<ExplicitSurface>> make_cell_surfaces(const TileMap& tile, std::uint64_t max_bytes) {
  if (tile.voxel_count() * sizeof(std::uint32_t) > max_bytes) return too_much(max_bytes);
  const CellSorter sorter(tile);
  const CellVoxels cells = sorter.sort();
  std::vector<ExplicitSurface> surfaces(tile.cell_count);
  std::uint64_t bytes = 0;
  PaddedVoxels box;
  for (std::uint32_t c = 0; c < tile.cell_count; ++c) {
    if (cells.begin[c] == cells.begin[c + std::size_t{1}]) continue;
    LatticePoint size{};
    std::uint64_t padded = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      size[a] = cells.high[c][a] - cells.low[c][a];
      padded *= std::uint64_t(size[a]) + 2 * PaddedVoxels::kPad;
      if (padded > max_bytes) return too_much(max_bytes);
    }
    box.reset(size);
    for (std::uint64_t k = cells.begin[c]; k < cells.begin[c + std::size_t{1}]; ++k) {
      const std::uint32_t index = cells.voxels[k];
      LatticePoint v = sorter.place(index, tile.id(index));
      for (std::size_t a = 0; a < 3; ++a) v[a] -= cells.low[c][a];
      box.at(v) = 1;
    }
    surfaces[c] = mesh_box(box, cells.low[c]);
    bytes += surfaces[c].vertices.capacity() * sizeof(surfaces[c].vertices[0]) +
             surfaces[c].squares.capacity() * sizeof(surfaces[c].squares[0]);
    if (bytes > max_bytes) return too_much(max_bytes);
  }
  return surfaces;
}

Result<std::vector<std::uint8_t>> find_exposed_instances(const CellObject& object, unsigned threads,
                                                         const Progress* progress) {
  const InsideTiles tiles(object, {{0, 0, 0}, object.grid.tiles});
  const TileContacts contacts(object.tile);
  const TileMap& tile = object.tile;
  const MembershipMap& membership = object.membership;
  std::vector<std::uint64_t> first(membership.entries.size() + 1, 0);
  for (std::uint64_t t = 0; t < membership.entries.size(); ++t) {
    std::uint64_t inside = 0;
    for (std::uint32_t c = 1; c <= membership.cell_count; ++c) inside += membership.tag(t, c) == Tag::kInside;
    first[std::size_t(t) + 1] = first[std::size_t(t)] + inside;
  }
  // Pieces of each cell with what they touch: a piece in a tile tells of an instance whose home may be in
  // another, so each instance asks for its own pieces, and slots are written by one thread each.
  struct Touch {
    std::uint32_t piece, other;
    LatticePoint step;  ///< to the tile of the other
  };
  std::vector<std::vector<Touch>> touches(tile.cell_count);
  const auto touch = [&](std::uint32_t piece, std::uint32_t other, const LatticePoint& step) {
    if (piece != 0) touches[tile.pieces[piece - 1].cell - 1u].push_back({piece, other, step});
  };
  for (const TileContacts::Contact& c : contacts.within()) {
    touch(c.lower, c.upper, {});
    touch(c.upper, c.lower, {});
  }
  for (std::size_t a = 0; a < 3; ++a)
    for (const TileContacts::Contact& c : contacts.across(a)) {
      LatticePoint step{};
      step[a] = 1;
      touch(c.lower, c.upper, step);
      step[a] = -1;
      touch(c.upper, c.lower, step);
    }
  std::vector<std::uint8_t> exposed(std::size_t(first.back()), 0);
  const Index3& n = object.grid.tiles;
  const bool done = parallel_for(
      n[2], threads,
      [&](std::size_t z, unsigned) {
        std::uint64_t home = std::uint64_t{n[0]} * n[1] * z;
        LatticePoint h{0, 0, std::int32_t(z)};
        for (h[1] = 0; h[1] < std::int32_t(n[1]); ++h[1])
          for (h[0] = 0; h[0] < std::int32_t(n[0]); ++h[0], ++home) {
            std::uint64_t slot = first[std::size_t(home)];
            for (std::uint32_t c = 1; c <= membership.cell_count; ++c) {
              if (membership.tag(home, c) != Tag::kInside) continue;
              for (const Touch& at : touches[c - 1]) {
                const Piece& piece = tile.pieces[at.piece - 1];
                LatticePoint own = h, other{};
                for (std::size_t a = 0; a < 3; ++a) {
                  own[a] -= piece.home[a];
                  other[a] = own[a] + at.step[a];
                }
                if (tiles.entry(own) == InsidePieces::kNone || tiles.has(tiles.entry(other), at.other))
                  continue;
                exposed[std::size_t(slot)] = 1;
                break;
              }
              ++slot;
            }
          }
      },
      progress, "finding buried instances");
  if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
  return exposed;
}

}  // namespace mesocell
