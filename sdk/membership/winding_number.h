#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/api.h"
#include "sdk/core/box_tree.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// The winding number of a closed mesh about points, exactly: how often the surface goes around a point,
/// positive if its triangles are counter-clockwise seen from outside. A point is inside where it is not 0.
/// [spec 4.3]
///
/// A point p on the surface counts as p + (ε, ε², ε³) with ε → 0+, so two solids that share a face partition
/// the points on it. Signs are those of exact predicates. Thread safety: const and reentrant.
class WindingNumber {
 public:
  /// `mesh`: closed (see MeshDiagnosis::closed(); of another one the answer means nothing), fewer than 2^31
  /// triangles, coordinates below 1e100 in magnitude; it need not live on. `threads`: 0 for the machine's.
  explicit WindingNumber(const TriangleMesh& mesh, unsigned threads = 0);

  /// `p`: finite. The time is that of looking at the triangles on the line from p along -x. No allocation.
  [[nodiscard]] std::int32_t at(Vec3 p) const;

 private:
  BoxTree tree_;
  /// In the tree's order.
  std::vector<std::array<Vec3, 3>> triangles_;
};

}  // namespace mesocell
