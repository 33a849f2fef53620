#pragma once

#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/membership/solid_shape.h"
#include "sdk/membership/tag_instances.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// Inside and outside of a shape at the voxel centres of a grid. A box of voxels is halved along its longest
/// side until the shape says that all of it is on one side, or a voxel is left, whose centre is asked for:
/// near the surface a few questions a voxel, elsewhere next to none.
class ShapeRows final : public RowSource {
 public:
  /// Both are kept by reference, as far as they are not copied.
  ShapeRows(const SolidShape& shape, const GridLayout& grid, const Index3& resolution)
      : shape_(shape), grid_(grid), resolution_(resolution) {}

  void bundle(std::uint32_t ty, std::uint32_t tz, Scanline::Scratch& scratch,
              RowIntervals& out) const override;
  void triangles(std::uint32_t, std::uint32_t,
                 const std::function<void(const std::array<Vec3, 3>&)>&) const override {}

 private:
  /// Voxels [low, high) of the grid.
  struct Block {
    Index3 low, high;
  };
  [[nodiscard]] Vec3 centre(const Index3& voxel) const;
  void split(const Block& block, const Index3& first, std::vector<std::vector<Interval>>& rows) const;

  const SolidShape& shape_;
  GridLayout grid_;
  Index3 resolution_;
};

}  // namespace mesocell
