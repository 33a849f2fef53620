#pragma once

#include <optional>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/surface/color_field.h"

namespace mesocell MESOCELL_API {

/// Bakes colors onto the surface of a cell object, in color voxels finer than its instances. Tiles with
/// INSIDE voxels get them, unless they and all 26 around them are INSIDE as a whole; in these, color voxels
/// that have a voxel of the object's surface, which a gap between cells shows as well. The color is the mean,
/// in linear light, of the field at the centres of up to eight of its faces there, evenly chosen.
/// - `resolution`: color voxels along each axis of a tile, 1…SurfaceColors::kMaxResolution each; along an
/// axis
///   with fewer voxels it is their number
/// - `threads`: 0 for the machine's; colors depend on neither threads nor machine
/// Absent if no tile gets any. Time grows with the faces of the tile's pieces times the tiles at the surface,
/// memory beside the result with the former. Errors: kUsage (the resolution), kLimit (more colors than
/// readers accept, or too many faces), kCancelled.
[[nodiscard]] Result<std::optional<SurfaceColors>> make_surface_colors(const CellObject& object,
                                                                       const ColorField& field,
                                                                       const Index3& resolution,
                                                                       unsigned threads = 0,
                                                                       const Progress* progress = nullptr);

}  // namespace mesocell
