#pragma once

#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/surface/color_field.h"
#include "sdk/surface/surface_paint.h"

namespace mesocell MESOCELL_API {

/// Colors of the INSIDE instances of a cell object, in the order of CellObject::instance_colors: each has
/// that of the field at its centre, the mean of its voxels' centres. `threads`: 0 for the machine's; colors
/// depend on neither threads nor machine. Time grows with the number of INSIDE instances. Errors: kLimit
/// (more instances than readers accept), kCancelled.
[[nodiscard]] Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object,
                                                             const ColorField& field, unsigned threads = 0,
                                                             const Progress* progress = nullptr);

/// The same of a mesh with all that is painted on it. `object`: from `mesh`, or from another of about the
/// same size and place. Errors beside: those of make_mesh_color_field().
[[nodiscard]] Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object,
                                                             const TriangleMesh& mesh,
                                                             const SurfacePaint& paint, unsigned threads = 0,
                                                             const Progress* progress = nullptr);

/// The same of a mesh with the colors of its vertices.
[[nodiscard]] Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object,
                                                             const TriangleMesh& mesh, unsigned threads = 0,
                                                             const Progress* progress = nullptr);

}  // namespace mesocell
