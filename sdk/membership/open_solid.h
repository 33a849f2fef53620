#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/cap_gradient.h"
#include "sdk/membership/winding_field.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// The inside of a mesh that is not closed, by its generalized winding number w: the points with |w| > 1/2.
/// [Jacobson 2013]
///
/// The mesh is closed by caps, see cap_boundary(). Of the closed mesh the winding number n is whole and found
/// exactly, row by row; w = n - c, where c is what the caps alone contribute. So |w| > 1/2 exactly where n is
/// not the whole number k nearest to c. Off the caps c is smooth, and how steep it is at most follows from
/// the caps and their loops; so k is found once for whole blocks of voxels, and c is evaluated voxel by voxel
/// only where it is near k + 1/2, near the boundary and on the caps. That leaves no triangle out, does not
/// depend on the caps, and costs time near holes only, as the area of their half-way surfaces.
class OpenSolid {
 public:
  /// `mesh` in voxel units, of any topology, and `chain`: its boundary, see boundary_chain(); `size`: of the
  /// grid, voxels. Cancelled, it is left without stretches.
  OpenSolid(const TriangleMesh& mesh, const std::vector<std::array<std::uint32_t, 2>>& chain,
            const Index3& size, unsigned threads = 0, const Progress* progress = nullptr);

  /// The mesh and behind its triangles the caps. Closed.
  [[nodiscard]] const TriangleMesh& closed() const { return closed_; }
  /// Voxels [begin, end) of a row along x.
  struct Stretch {
    std::uint32_t begin, end;
    std::int16_t whole;  ///< k, the whole number nearest to c; half-way between two the lesser in magnitude
    /// Where c is near whole + 1/2 or whole - 1/2: 1 or -1; else 0.
    std::int8_t unsure;
  };
  /// Calls `visit(stretch)` for those of the row (·, y, z), ascending. Between them `whole` is 0 and nothing
  /// is unsure.
  template <class Visit>
  void for_stretches(std::uint32_t y, std::uint32_t z, Visit&& visit) const;
  /// Whether the row has none.
  [[nodiscard]] bool is_plain(std::uint32_t y, std::uint32_t z) const {
    const std::size_t r = row_of_blocks(y, z);
    return first_.empty() || first_[r] == first_[r + 1];
  }
  /// Voxels for which c was evaluated one by one.
  [[nodiscard]] std::uint64_t evaluated_voxels() const { return codes_.size(); }

 private:
  static constexpr std::uint32_t kBlock = 4, kBlockVoxels = kBlock * kBlock * kBlock;
  static constexpr std::uint64_t kAlike = ~std::uint64_t{0};

  /// A row of blocks' part: all alike, or with codes voxel by voxel, of the block at `begin`.
  struct Part {
    Stretch what;
    std::uint64_t codes;  ///< kAlike, or the place of the block's codes
  };
  /// Blocks of `edge`³ voxels, or of less where the grid ends.
  struct Block {
    std::array<std::uint32_t, 3> low;
    std::uint32_t edge;
    Part part;
  };
  /// What was found in a part of the grid.
  struct Found {
    const Progress* progress = nullptr;  ///< looked to for cancellation
    std::vector<Block> blocks;
    std::vector<std::int16_t> codes;
    WindingField::Local local;
  };
  void find_blocks(const std::array<std::uint32_t, 3>& low, std::uint32_t edge, std::uint32_t coarsest,
                   Found& out) const;
  void evaluate_block(const std::array<std::uint32_t, 3>& low, const Box3& box, Found& out) const;
  [[nodiscard]] std::int16_t evaluate(const WindingField::Local& local, Vec3 centre) const;
  void lay_out(std::vector<Found>& found);
  [[nodiscard]] std::size_t row_of_blocks(std::uint32_t y, std::uint32_t z) const {
    return y / kBlock + std::size_t{(size_[1] + kBlock - 1) / kBlock} * (z / kBlock);
  }

  TriangleMesh closed_;
  Index3 size_;
  WindingField caps_;
  CapGradient gradient_;
  /// Rows of blocks of kBlock² rows: (y, z) / kBlock has parts_[first_[r]] … parts_[first_[r + 1]].
  std::vector<std::uint64_t> first_;
  std::vector<Part> parts_;
  /// Of each block that was evaluated kBlockVoxels, x fastest: 4 · whole + unsure + 1.
  std::vector<std::int16_t> codes_;
};

template <class Visit>
void OpenSolid::for_stretches(std::uint32_t y, std::uint32_t z, Visit&& visit) const {
  if (first_.empty()) return;
  const std::size_t r = row_of_blocks(y, z);
  for (std::uint64_t k = first_[r]; k < first_[r + 1]; ++k) {
    const Part& part = parts_[k];
    if (part.codes == kAlike) {
      visit(part.what);
      continue;
    }
    const std::int16_t* const codes =
        codes_.data() + part.codes + kBlock * (y % kBlock + kBlock * (z % kBlock));
    for (std::uint32_t x = part.what.begin; x < part.what.end; ++x) {
      const std::int16_t code = codes[x - part.what.begin];
      visit(Stretch{x, x + 1, std::int16_t(code >> 2), std::int8_t((code & 3) - 1)});
    }
  }
}

}  // namespace mesocell
