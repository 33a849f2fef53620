#pragma once

#include <array>
#include <vector>

#include "converters/import/plain_mesh.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// What the library delivers: a soup, each face as it stands in the file.
struct LibraryMesh {
  std::vector<std::array<float, 3>> points;
  std::vector<Triangle> triangles;  ///< indices are below points.size()
};

/// Reads a checked mesh with OpenMesh. Half-edges are not built: they would silently double non-manifold
/// vertices. Calls are serialised, since the library's readers keep state. Trust: `mesh` comes from
/// plain_mesh.h; all the same, more elements than it promises or an index out of range end the reading.
/// Errors: kInvalidInput, kLimit (out of memory), kCancelled.
[[nodiscard]] Result<LibraryMesh> read_with_openmesh(const PlainMesh& mesh, const Progress* progress);

}  // namespace mesocell
