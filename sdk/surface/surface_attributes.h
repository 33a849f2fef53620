#pragma once

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/surface/explicit_surface.h"

namespace mesocell {

/// Gives a surface of an object, in voxels of its grid, the colors and normals that options ask for. Errors:
/// kCancelled.
[[nodiscard]] Status add_attributes(const CellObject& object, const SurfaceOptions& options,
                                    ExplicitSurface& surface, const Progress* progress);

}  // namespace mesocell
