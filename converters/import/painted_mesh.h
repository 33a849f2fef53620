#pragma once

#include <cstdint>
#include <vector>

#include "converters/import/mesh_warning.h"
#include "converters/import/read_notes.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/surface/surface_paint.h"

namespace mesocell {

/// A mesh with all that colors it.
struct PaintedMesh {
  TriangleMesh mesh;
  SurfacePaint paint;
};

/// What a worker read of a file.
struct WorkerMesh {
  PaintedMesh painted;
  std::vector<MeshWarning> warnings;
  ReadNotes notes;                  ///< no files, which a worker cannot read
  std::uint64_t polygons = 0;       ///< faces as the file has them
  std::uint64_t dropped_faces = 0;  ///< of them those with two equal corners
};

}  // namespace mesocell
