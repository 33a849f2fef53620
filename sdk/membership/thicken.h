#pragma once

#include <cstdint>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// A mesh whose open parts have a thickness, and what was done to it.
struct ThickenedMesh {
  TriangleMesh mesh;  ///< without colors
  std::uint64_t thickened_components = 0, thickened_triangles = 0;
};

/// Replaces the open components of a mesh, those that hang together by edges and have one that is not run
/// along equally often in both directions, by what is within thickness / 2 of them: a plate with round rims.
/// The result is closed, a union of convex polyhedra of winding number 1 that overlap: a prism about each
/// triangle, wedges along edges on the side where they bend away, and balls at the vertices of such edges. So
/// a point is in it if it is within thickness / 2 of the inner of a triangle or within 0.92 of that of the
/// rest, and is not if it is farther than thickness / 2. Closed components stay as they are; they should be
/// oriented outward, see orient(), as the pieces cancel what has the winding number -1. Vertices at identical
/// coordinates count as one. The pieces meet inside of the solid, so the surfaces of the result are not all
/// on its border.
/// - `thickness`: metres, above 0 (kUsage)
/// - errors: kLimit (over 2²⁵ triangles), kCancelled
[[nodiscard]] Result<ThickenedMesh> thicken(const TriangleMesh& mesh, double thickness,
                                            const Progress* progress = nullptr);

}  // namespace mesocell
