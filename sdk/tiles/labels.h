#pragma once

#include <cstdint>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/tiles/tile_spec.h"

namespace mesocell {

/// Which cell each voxel of a tile is of, as somebody else has it: segmented scans, painted stacks of images.
struct LabelVolume {
  Index3 resolution{};                ///< voxels along x, y, z
  std::vector<std::uint32_t> labels;  ///< x fastest; 0 is empty space, other values are names without order

  [[nodiscard]] std::uint64_t voxel_count() const {
    return std::uint64_t{resolution[0]} * resolution[1] * resolution[2];
  }
};

/// What to do with a cell that meets its own copy through the tile's border, which has no end.
enum class Percolating : std::uint8_t {
  kCut,     ///< each voxel goes to the nearest image of the cell's centroid
  kRefuse,  ///< kInvalidInput, "tile-percolates"
};

/// Makes the tile of a label volume. A cell is what is connected through faces, edges and corners (26
/// neighbours), around the torus; so a label of several parts gives several cells, in the order of their
/// labels, then of their first voxels. Untrusted input: safe. Errors: kInvalidInput (a resolution not in
/// 4…1024, no voxel that is not empty, refused cells), kLimit (more than 65 535 cells, or cells longer than
/// 100 tiles), kCancelled.
[[nodiscard]] Result<TileMap> make_label_tile(const LabelVolume& volume, Percolating percolating,
                                              unsigned threads = 0, TileReport* report = nullptr,
                                              const Progress* progress = nullptr);

}  // namespace mesocell
