#pragma once

#include <array>
#include <cstdint>

#include "format/cell_object.h"
#include "sdk/tiles/assemble.h"
#include "sdk/tiles/tile_spec.h"

namespace mesocell {

/// Turns "voxel v belongs to image s of cell c" into a TileMap: finds each instance's home tile, the pieces,
/// and the narrowest ids. Image s of a cell is its seed moved by s tiles, so v - s·resolution is the voxel's
/// place in the instance whose seed lies in this tile.
class TileBuilder {
 public:
  /// All voxels are empty at first. `cells` in 1…65535. Images up to `reach` tiles away on each axis can be
  /// given.
  TileBuilder(Index3 resolution, std::uint32_t cells, std::int32_t reach = 1);

  /// Images a cell has.
  [[nodiscard]] std::uint32_t images() const { return images_; }
  /// Images are numbered by (s_z, s_y, s_x) ascending, each component in [-reach, reach].
  [[nodiscard]] std::uint32_t image_index(std::int32_t sx, std::int32_t sy, std::int32_t sz) const {
    const std::int32_t n = 2 * reach_ + 1;
    return std::uint32_t(sx + reach_ + n * (sy + reach_ + n * (sz + reach_)));
  }
  [[nodiscard]] std::array<std::int32_t, 3> image_shift(std::uint32_t index) const {
    const std::uint32_t n = std::uint32_t(2 * reach_ + 1);
    return {std::int32_t(index % n) - reach_, std::int32_t(index / n % n) - reach_,
            std::int32_t(index / (n * n)) - reach_};
  }
  /// One number for a cell (1…) and an image; orders by cell, then by image.
  [[nodiscard]] std::uint32_t code(std::uint32_t cell, std::uint32_t image) const {
    return (cell - 1) * images_ + image + 1;
  }

  /// Gives voxel `i` (x fastest) to a code. Different voxels may be set from different threads.
  void set(std::uint64_t i, std::uint32_t code) { codes_.set(i, code); }

  /// The finished tile. Cells that got no voxel are left out and the rest renumbered in order; the report
  /// says how many. At least one voxel must have been set (assert).
  [[nodiscard]] TileMap finish(unsigned threads, TileReport* report) const;

 private:
  Index3 resolution_;
  std::uint32_t cells_;
  std::int32_t reach_;
  std::uint32_t images_;
  VoxelCodes codes_;
};

}  // namespace mesocell
