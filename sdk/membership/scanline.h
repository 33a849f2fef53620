#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/solid.h"

namespace mesocell MESOCELL_INTERNAL_API {

class OpenSolid;

/// Voxels [begin, end) of one row along x that are inside the mesh.
struct Interval {
  std::uint32_t begin, end;
};

/// The inside intervals of a bundle of rows; row r has intervals[first[r]] … intervals[first[r + 1]].
struct RowIntervals {
  std::vector<std::uint32_t> first;
  std::vector<Interval> intervals;

  [[nodiscard]] std::span<const Interval> row(std::size_t r) const {
    return {intervals.data() + first[r], intervals.data() + first[r + 1]};
  }
};

/// Inside and outside of a closed mesh at voxel centres, row by row, exactly.
///
/// A voxel is inside if the winding number of the mesh about its centre p is solid by the rule, where p
/// stands for p + (ε, ε², ε³) with ε → 0+, so that no centre lies on the surface. [spec 4.3] Rows run along
/// x; every decision that rounding could turn is left to exact predicates.
class Scanline {
 public:
  /// `mesh` is in voxel units, closed, its coordinates below 2^40; it is kept by reference. `resolution`:
  /// voxels of a tile, whose rows make a bundle; `tiles`: of the grid. `open`: that `mesh` is the closed()
  /// of, whose winding number then decides; null if the mesh is closed by itself. `solid`: kOuter counts as
  /// kNonzero, components are turned before.
  Scanline(const TriangleMesh& mesh, const Index3& resolution, const Index3& tiles,
           const OpenSolid* open = nullptr, SolidRule solid = SolidRule::kNonzero);

  /// Where the surface crosses a row: before the centre of voxel x, in 4 bytes, for there are many.
  class Crossing {
   public:
    Crossing() = default;
    /// `x`: below 2^31; `delta`: 1 or -1, what the winding number rises by.
    Crossing(std::uint32_t x, std::int32_t delta) : code_(x << 1 | (delta > 0)) {}
    [[nodiscard]] std::uint32_t x() const { return code_ >> 1; }
    [[nodiscard]] std::int32_t delta() const { return code_ & 1 ? 1 : -1; }
    /// By x first.
    bool operator<(const Crossing& c) const { return code_ < c.code_; }

   private:
    std::uint32_t code_;
  };
  struct RowCrossing {
    std::uint32_t row;
    Crossing crossing;
  };
  struct Scratch {
    std::vector<RowCrossing> found;
    std::vector<Crossing> sorted;
    std::uint64_t unsure = 0;  ///< voxels so far whose winding number was nearly 1/2
  };
  /// The rows of the tiles (·, ty, tz): row y + resolution_y · z, with y, z counted from the bundle's first.
  /// Thread safety: const; `out` and `scratch` belong to the caller and are reused between calls.
  void bundle(std::uint32_t ty, std::uint32_t tz, Scratch& scratch, RowIntervals& out) const;

  /// The triangles, by index, whose boxes are less than a voxel from the tiles (·, ty, tz), and maybe more.
  [[nodiscard]] std::span<const std::uint32_t> triangles(std::uint32_t ty, std::uint32_t tz) const {
    const std::size_t b = ty + std::size_t{tiles_[1]} * tz;
    return {triangles_.data() + first_[b], triangles_.data() + first_[b + 1]};
  }

 private:
  struct Rows {
    std::uint32_t y0, z0;
  };
  void add_triangle(std::uint32_t index, const Rows& rows, std::vector<RowCrossing>& found) const;

  const TriangleMesh& mesh_;
  const OpenSolid* open_;
  std::int32_t mask_;  ///< of the bits of a winding number that make it solid
  Index3 resolution_, tiles_;
  // Triangles by bundle: bundle b has triangles_[first_[b]] … triangles_[first_[b + 1]].
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace mesocell
