#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/core/box_tree.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/core/vec.h"

namespace mesocell {

/// A point of a mesh's surface, and how far another is from it.
struct SurfacePoint {
  Vec3 point;
  double distance = 0;         ///< metres, never negative
  std::uint32_t triangle = 0;  ///< the one that `point` is on
  /// Shares of the triangle's three vertices in `point`, from 0 to 1 with sum 1 but for rounding.
  std::array<double, 3> barycentric{};
};

/// The nearest point of a triangle mesh. Triangles may be degenerate: those without area count as the
/// segments or the points that they are. Of triangles that are equally near, the one of the lowest index is
/// found, so the answer depends on the mesh and the point alone; triangles that share the edge or the vertex
/// that is nearest are equally near. Thread safety: const and reentrant.
class ClosestPoint {
 public:
  /// `mesh`: has a triangle (assert), fewer than 2^31, and no coordinate beyond ±1e150; it need not live on.
  /// `threads`: 0 for the machine's.
  explicit ClosestPoint(const TriangleMesh& mesh, unsigned threads = 0);

  /// `p`: finite, no coordinate beyond ±1e150. The point found is within some units in the last place of its
  /// coordinates of the nearest. No allocation.
  [[nodiscard]] SurfacePoint query(Vec3 p) const;

  /// Around all triangles.
  [[nodiscard]] Box3 box() const { return tree_.box(); }

 private:
  BoxTree tree_;
  /// In the tree's order.
  std::vector<std::array<Vec3, 3>> triangles_;
};

}  // namespace mesocell
