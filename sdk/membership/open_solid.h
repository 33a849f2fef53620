#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/scanline.h"
#include "sdk/membership/winding_field.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// The inside of a mesh that is not closed, by its generalized winding number w: the points with |w| > 1/2.
/// [Jacobson 2013]
///
/// The boundary of the mesh is closed by cones, one for each of its connected parts. Of the closed mesh the
/// winding number n is whole and found exactly, row by row; w = n - c, where c is what the cones alone
/// contribute. Wherever |c| is well below 1/2 rounding w gives n, so nothing else is computed there; the
/// blocks of voxels where it may not be are kept in a list, and w is evaluated in them. That is exact in the
/// sense that no triangle is left out and no cone matters, and costs time only near holes.
class OpenSolid {
 public:
  /// `mesh` in voxel units, of any topology; `size`: of the grid, voxels.
  OpenSolid(const TriangleMesh& mesh, const Index3& size);

  /// The mesh and behind its triangles the cones. Closed.
  [[nodiscard]] const TriangleMesh& closed() const { return closed_; }
  /// Triangles of closed() that are of the mesh.
  [[nodiscard]] std::size_t mesh_triangles() const { return mesh_triangles_; }
  /// Whether the mesh was closed by itself, so that there is nothing to evaluate.
  [[nodiscard]] bool was_closed() const { return segments_ == 0; }
  /// Edges of the mesh's boundary, as often as it runs along them.
  [[nodiscard]] std::size_t boundary_edges() const { return segments_; }

  /// Where the winding number must be evaluated in the row of voxels (·, y, z): stretches [begin, end) along
  /// x, ascending.
  void stretches(std::uint32_t y, std::uint32_t z, std::vector<RowStretch>& out) const;

  /// The cones' share at a voxel's centre.
  [[nodiscard]] WindingField::Value cones(Vec3 centre) const { return cones_.approximate(centre); }
  [[nodiscard]] WindingField::Value cones_summed(Vec3 centre) const { return cones_.sum(centre); }
  /// The most that w can change along a piece of a row, per voxel, off the surface.
  [[nodiscard]] double gradient(const Box3& box) const { return gradient_.bound(box); }

 private:
  static constexpr std::uint32_t kBlock = 16;

  void find_blocks(const std::array<std::uint32_t, 3>& low, std::uint32_t edge, const Index3& size);

  TriangleMesh closed_;
  std::size_t mesh_triangles_ = 0, segments_ = 0;
  WindingField cones_;
  BoundaryGradient gradient_;
  /// Blocks of kBlock³ voxels in which w is evaluated, by (z, y, x), in units of blocks.
  std::vector<std::array<std::uint32_t, 3>> blocks_;
};

}  // namespace mesocell
