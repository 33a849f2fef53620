#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// Normals of the cells of a tile, each cell for itself: what is of another instance counts as outside,
/// whether it is empty or not. Which of a cell's faces are a surface only the membership tells; a caster that
/// knows it does better.
class CellNormals {
 public:
  explicit CellNormals(const TileMap& tile);

  /// The source's rule: the mean of the directions to those of 26 neighbours that are of another instance.
  /// Zero if there is none, or if they balance out. [Nürnberg 2011, 4.6]
  [[nodiscard]] Vec3 neighbour_normal(const std::array<std::uint32_t, 3>& voxel) const;

  /// The direction in which the instance ends, summed over the voxels up to four away with a weight that
  /// falls smoothly to 0. Where that balances out (walls of a few voxels), the neighbour normal, and +z if
  /// that is zero too.
  [[nodiscard]] Vec3 gradient_normal(const std::array<std::uint32_t, 3>& voxel) const;

 private:
  [[nodiscard]] bool same_instance(std::uint32_t id, const std::array<std::uint32_t, 3>& voxel,
                                   const std::array<std::int32_t, 3>& offset) const;

  const TileMap& tile_;
};

/// Gradient normals at all boundary voxels of a tile, as a cell object stores them. `threads` 0: the
/// machine's; the result does not depend on it. Empty if cancelled.
[[nodiscard]] std::optional<NormalMap> make_normal_map(const TileMap& tile, unsigned threads = 0,
                                                       const Progress* progress = nullptr);

}  // namespace mesocell
