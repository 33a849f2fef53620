#pragma once

#include <array>
#include <cstdint>

#include "format/cell_object.h"
#include "sdk/surface/explicit_surface.h"
#include "sdk/surface/tile_contacts.h"
#include "sdk/surface/voxel_mesher.h"
#include "sdk/trace/inside_pieces.h"

namespace mesocell {

/// The INSIDE instances of a box of tiles of an object; there is nothing beyond it. Thread safety: const.
class InsideTiles {
 public:
  /// `object` has to live on. The box lies in the grid (assert).
  InsideTiles(const CellObject& object, const TileBox& box);

  [[nodiscard]] const TileBox& box() const { return box_; }
  [[nodiscard]] const TileMap& tile() const { return tile_; }

  /// InsidePieces::entry() of a tile of the grid; kNone out of the box.
  [[nodiscard]] std::uint32_t entry(const LatticePoint& t) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (t[a] < std::int32_t(box_.begin[a]) || t[a] >= std::int32_t(box_.end[a])) return InsidePieces::kNone;
    return pieces_.entry(std::uint64_t(t[0]) +
                         tiles_[0] * (std::uint64_t(t[1]) + std::uint64_t{tiles_[1]} * std::uint64_t(t[2])));
  }
  [[nodiscard]] bool has(std::uint32_t entry, std::uint32_t id) const {
    return entry != InsidePieces::kNone && pieces_.has(entry, id);
  }
  /// Whether all voxels of a tile of this entry are INSIDE.
  [[nodiscard]] bool full(std::uint32_t entry) const { return solid_ && entry == InsidePieces::kAll; }

  /// How many faces the surface has of voxels of a tile.
  [[nodiscard]] std::uint64_t count_own_faces(const TileContacts& contacts, const LatticePoint& t) const;

  /// The voxels of a tile and what is around it.
  void fill(const LatticePoint& t, PaddedVoxels& voxels) const;

 private:
  const TileMap& tile_;
  Index3 tiles_;
  TileBox box_;
  InsidePieces pieces_;
  bool solid_ = true;
};

}  // namespace mesocell
