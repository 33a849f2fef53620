#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// How many faces voxels of one piece of a tile have in common with those of another: what the surface of
/// any set of instances is counted from without looking at voxels again.
class TileContacts {
 public:
  /// A number of faces between voxels of two pieces, ids from 1, 0 for empty space.
  struct Contact {
    std::uint32_t lower, upper;  ///< piece ids; across a border of tiles `upper` is the next tile's
    std::uint64_t faces;
  };

  explicit TileContacts(const TileMap& tile);

  /// Within a tile; no two have the same pieces, and none is of a piece with itself.
  [[nodiscard]] const std::vector<Contact>& within() const { return within_; }
  /// Across the upper border of a tile on an axis; a piece may be there with itself.
  [[nodiscard]] const std::vector<Contact>& across(std::size_t axis) const { return across_[axis]; }

 private:
  std::vector<Contact> within_;
  std::array<std::vector<Contact>, 3> across_;
};

}  // namespace mesocell
