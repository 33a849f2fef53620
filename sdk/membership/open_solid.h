#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/winding_field.h"

namespace mesocell {

/// The inside of a mesh that is not closed, by its generalized winding number w: the points with |w| > 1/2.
/// [Jacobson 2013]
///
/// The mesh is closed by caps, see cap_boundary(). Of the closed mesh the winding number n is whole and found
/// exactly, row by row; w = n - c, where c is what the caps alone contribute. So |w| > 1/2 exactly where n is
/// not the whole number k nearest to c. Off the caps c is smooth, and how steep it is at most follows from
/// the boundary; so k is found once for whole blocks of voxels, and c is evaluated voxel by voxel only where
/// it is near k + 1/2, near the boundary and on the caps. That leaves no triangle out, does not depend on
/// the caps, and costs time near holes only, as the area of their half-way surfaces.
class OpenSolid {
 public:
  /// `mesh` in voxel units, of any topology, and `chain`: its boundary, see boundary_chain(); `size`: of the
  /// grid, voxels. Cancelled, it is left without stretches.
  OpenSolid(const TriangleMesh& mesh, const std::vector<std::array<std::uint32_t, 2>>& chain,
            const Index3& size, unsigned threads = 0, const Progress* progress = nullptr);

  /// The mesh and behind its triangles the caps. Closed.
  [[nodiscard]] const TriangleMesh& closed() const { return closed_; }
  /// Triangles of closed() that are of the mesh.
  [[nodiscard]] std::size_t mesh_triangles() const { return mesh_triangles_; }
  /// Voxels [begin, end) of a row along x.
  struct Stretch {
    std::uint32_t begin, end;
    std::int16_t whole;  ///< k, the whole number nearest to c
    /// Where c is near whole + 1/2 or whole - 1/2: 1 or -1; else 0.
    std::int8_t unsure;
    bool evaluate;   ///< c must be evaluated; `whole` and `unsure` say nothing
    float gradient;  ///< the most that w can change from voxel to voxel off the surface, if `evaluate`
  };
  /// Those of the row (·, y, z), ascending. Between them `whole` is 0 and nothing is unsure.
  [[nodiscard]] std::span<const Stretch> stretches(std::uint32_t y, std::uint32_t z) const;

  /// The caps' share at a voxel's centre.
  [[nodiscard]] WindingField::Value caps(Vec3 centre, double tolerance) const {
    return caps_.approximate(centre, tolerance);
  }
  [[nodiscard]] WindingField::Value caps_summed(Vec3 centre) const { return caps_.sum(centre); }

 private:
  static constexpr std::uint32_t kBlock = 4;

  /// Blocks of `edge`³ voxels, or of less where the grid ends.
  struct Block {
    std::array<std::uint32_t, 3> low;
    std::uint32_t edge;
    Stretch what;  ///< for each of its rows
  };
  void find_blocks(const std::array<std::uint32_t, 3>& low, std::uint32_t edge, std::uint32_t coarsest,
                   std::vector<Block>& out) const;
  void lay_out(const std::vector<std::vector<Block>>& blocks);

  TriangleMesh closed_;
  Index3 size_;
  std::size_t mesh_triangles_ = 0;
  WindingField caps_;
  CapGradient gradient_;
  /// Rows of blocks of kBlock² rows: (y, z) / kBlock has stretches_[first_[r]] … stretches_[first_[r + 1]].
  std::vector<std::uint64_t> first_;
  std::vector<Stretch> stretches_;
};

}  // namespace mesocell
