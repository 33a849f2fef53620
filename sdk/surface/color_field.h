#pragma once

#include <functional>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/core/vec.h"
#include "sdk/surface/surface_paint.h"

namespace mesocell MESOCELL_API {

/// The color at a point, in linear light, 0 to 1. Points are in voxels of an object's grid from its minimum
/// corner, so that neither the size of the object nor its distance from the origin costs precision. Called
/// from any thread.
using ColorField = std::function<Vec3(Vec3)>;

/// The color of a mesh where its surface is nearest to the point, with all that is painted on it, by
/// PaintSampler; colors of a triangle's vertices are mixed in linear light by barycentric coordinates. `mesh`
/// and `paint` must outlive the field, and `paint` fits `mesh` (assert). `threads`: 0 for the machine's; the
/// field depends on neither threads nor machine. Errors: kUsage (the mesh has no colors), kInvalidInput (it
/// reaches more than 2^40 voxels beyond the grid).
[[nodiscard]] Result<ColorField> make_mesh_color_field(const GridLayout& grid, const TriangleMesh& mesh,
                                                       const SurfacePaint& paint, unsigned threads = 0);

/// Colors that are given at points in metres, sRGB.
[[nodiscard]] ColorField make_color_field(const GridLayout& grid, std::function<Rgb8(Vec3)> color_at);

/// The error of a mesh whose colors are wanted but which has none.
[[nodiscard]] Error mesh_without_colors();

}  // namespace mesocell
