#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/box_tree.h"
#include "sdk/core/vec.h"
#include "sdk/trace/inside_pieces.h"

namespace mesocell MESOCELL_API {

/// How far points are from the solid of a cell object, the union of the closed voxels of its INSIDE
/// instances. An octree finds tiles that have any, a tree over the pieces of the tile finds pieces, and a
/// tree over the runs of voxels of each piece, shared by all tiles, finds the voxel. Memory does not grow
/// with the number of instances: it is a seventh of a byte a tile of the grid, and some 60 bytes a run.
/// Thread safety: const and reentrant.
class NearestCell {
 public:
  /// `object` need not live on. `threads`: 0 for the machine's. Errors: kInvalidInput (no instance is
  /// INSIDE), kLimit (the tile has more than 2^24 runs of voxels of one instance along x).
  [[nodiscard]] static Result<NearestCell> make(const CellObject& object, unsigned threads = 0);

  /// Distance of a finite point, metres; 0 in the solid. Exact but for the rounding of coordinates. No
  /// allocation.
  [[nodiscard]] double distance(Vec3 point) const;

 private:
  /// Voxels [x0, x1) of a row of the tile.
  struct Run {
    std::uint16_t x0, x1, y, z;
  };
  /// The voxels of a piece, in the order of the tree.
  struct Shape {
    BoxTree tree;
    std::vector<Run> runs;
  };

  NearestCell(const CellObject& object, InsidePieces inside, const std::vector<std::vector<Run>>& runs,
              unsigned threads);

  static Box3 box_of(const Run& run) {
    return {{double(run.x0), double(run.y), double(run.z)}, {double(run.x1), run.y + 1.0, run.z + 1.0}};
  }
  static std::vector<Box3> boxes_of(const std::vector<Run>& runs);
  void find_blocks();
  [[nodiscard]] double visit_tile(const Index3& tile, Vec3 q, double limit) const;

  Index3 resolution_{}, tiles_{};
  Vec3 corner_;
  double voxel_edge_;
  InsidePieces inside_;
  /// blocks_[k]: of blocks of 2^(k+1) tiles a side, x fastest, which of their eight halves have INSIDE
  /// voxels; bit x + 2·y + 4·z. The last level has one block.
  std::vector<std::vector<std::uint8_t>> blocks_;
  std::vector<Shape> shapes_;  ///< piece id k is shapes_[k - 1]
  BoxTree pieces_;             ///< over the boxes of the pieces, in the tile
};

}  // namespace mesocell
