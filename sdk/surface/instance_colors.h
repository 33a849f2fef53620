#pragma once

#include <functional>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/core/vec.h"
#include "sdk/surface/surface_paint.h"

namespace mesocell MESOCELL_API {

/// The colors of a mesh on the INSIDE instances of a cell object, in the order of
/// CellObject::instance_colors: each has the color of the mesh where its surface is nearest to the instance's
/// centre, the mean of its voxels' centres. Colors of a triangle's vertices are mixed in linear light by
/// barycentric coordinates.
/// - `object`: from `mesh`, or from another of about the same size and place
/// - `threads`: 0 for the machine's; colors depend on neither threads nor machine
/// Time grows with the number of INSIDE instances, memory beside the result with that of triangles.
/// Errors: kUsage (the mesh has no colors), kInvalidInput (it reaches more than 2^40 voxels beyond the grid),
/// kLimit (more instances than readers accept), kCancelled.
[[nodiscard]] Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object,
                                                             const TriangleMesh& mesh, unsigned threads = 0,
                                                             const Progress* progress = nullptr);

/// The same of a mesh with all that is painted on it, by PaintSampler. `paint` fits `mesh` (assert).
[[nodiscard]] Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object,
                                                             const TriangleMesh& mesh,
                                                             const SurfacePaint& paint, unsigned threads = 0,
                                                             const Progress* progress = nullptr);

/// The same from colors that are defined in space: each instance has the color at its centre. `color_at` is
/// given a point in metres, from any thread. Errors: kLimit, kCancelled.
[[nodiscard]] Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object,
                                                             const std::function<Rgb8(Vec3)>& color_at,
                                                             unsigned threads = 0,
                                                             const Progress* progress = nullptr);

/// The error of a mesh whose colors are wanted but which has none.
[[nodiscard]] Error mesh_without_colors();

}  // namespace mesocell
