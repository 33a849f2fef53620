#pragma once

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// A closed, oriented, 2-manifold surface around any triangle soup, free of self-intersections: the alpha
/// wrap [Portaneri 2022], by CGAL. It lies outside of the soup, up to about `offset` from what a ball of
/// radius `alpha` can touch from outside; what such a ball cannot enter, holes and cavities, is closed over.
/// This library is under the GPL as it stands, for CGAL's package is: nothing else of the SDK links it. The
/// same input gives the same mesh. No colors. The time and memory grow with the number of triangles of about
/// alpha's size that cover the soup; `progress` can stop most of it.
/// - `alpha`, `offset`: metres, above 0 (kUsage)
/// - errors: kInvalidInput (no triangles, or none of an extent), kLimit (over 500 000 vertices), kCancelled
[[nodiscard]] Result<TriangleMesh> alpha_wrap(const TriangleMesh& mesh, double alpha, double offset,
                                              const Progress* progress = nullptr);

}  // namespace mesocell
