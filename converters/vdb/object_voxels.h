#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "converters/vdb/sparse_volume.h"
#include "format/cell_object.h"

namespace mesocell {

/// What the voxels of a cell object's grid are of. Keeps the object by reference. Thread safety: const.
class ObjectVoxels {
 public:
  explicit ObjectVoxels(const CellObject& object);

  /// Voxels along x, y, z; at most SparseVolume::kReach, see fits().
  [[nodiscard]] const VoxelCoord& size() const { return size_; }
  /// Whether a grid is not too large for this.
  [[nodiscard]] static bool fits(const CellObject& object);

  struct Found {
    std::uint32_t cell = 0;   ///< 0: empty space, or beyond the grid
    std::uint64_t home = 0;   ///< the index of the instance's home tile; none if the tag is kOutside
    Tag tag = Tag::kOutside;  ///< also of instances whose home is beyond the grid
  };

  /// Looks voxels up, best near to each other. For one thread.
  class Reader {
   public:
    explicit Reader(const ObjectVoxels& voxels) : voxels_(voxels) {}
    [[nodiscard]] Found at(const VoxelCoord& voxel);

   private:
    using Pieces = std::vector<Found>;  ///< of a tile, by piece id
    const ObjectVoxels& voxels_;
    std::unordered_map<std::uint64_t, Pieces> known_;
    std::uint64_t last_tile_ = ~std::uint64_t{0};
    const Pieces* last_ = nullptr;
  };

 private:
  /// A coordinate of a voxel along an axis.
  struct Place {
    std::uint32_t tile, in_tile;
  };
  [[nodiscard]] std::vector<Found> pieces_of(const Index3& tile) const;

  const CellObject& object_;
  VoxelCoord size_{};
  std::array<std::vector<Place>, 3> places_;
};

}  // namespace mesocell
