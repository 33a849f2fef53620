#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/triangle_box.h"

namespace mesocell {

/// Finds the pieces of a tile that a triangle touches: those with a voxel whose closed box it meets.
/// [spec 4.3] Looks at blocks of voxels first, and not at blocks all of whose pieces are known to be touched.
/// Thread safety: const.
class TouchFinder {
 public:
  explicit TouchFinder(const TileMap& tile);

  /// What mark() sets.
  static constexpr std::uint8_t kTouched = 3;

  /// Sets `pieces[id]` to kTouched for every piece that the triangle touches, in the tile whose minimum
  /// corner is voxel `corner`. `pieces` has an entry for each piece and entry 0, the empty space, whose value
  /// means nothing.
  void mark(const std::array<Vec3, 3>& triangle, const std::array<std::int64_t, 3>& corner,
            std::span<std::uint8_t> pieces) const;

 private:
  static constexpr std::uint32_t kBlock = 8;

  void mark_block(const std::array<Vec3, 3>& triangle, const std::array<std::int64_t, 3>& corner,
                  const Index3& low, const Index3& high, std::span<std::uint8_t> pieces) const;

  const TileMap& tile_;
  Index3 blocks_{};
  /// Pieces in block b: ids_[first_[b]] … ids_[first_[b + 1]].
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace mesocell
