#pragma once

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// Compresses a mesh to keep in a cell object: positions are rounded to 2^`position_bits` - 1 steps along the
/// longest side of its box, and to single precision; `max_error` bounds both. Order of vertices and triangles
/// changes, and triangles with a repeated vertex are left out. Colors of vertices are kept. Errors: kUsage
/// (bits not in 8…24), kInvalidInput (no triangle is left, a coordinate beyond single precision), kLimit.
[[nodiscard]] Result<BasicMesh> compress_basic_mesh(const TriangleMesh& mesh, int position_bits = 20);

/// The mesh again, decoded by a worker. Untrusted input: safe. Errors: kInvalidInput (it is no Draco mesh, or
/// not of as many vertices and triangles as stated), kLimit, kCancelled, kOutput (the worker is not there).
[[nodiscard]] Result<TriangleMesh> read_basic_mesh(const BasicMesh& mesh, const Progress* progress = nullptr);

}  // namespace mesocell
