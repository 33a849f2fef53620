#pragma once

#include <cstdint>
#include <optional>

#include "format/api.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// A mesh whose triangles agree on what is outside as far as they can, and what was done to it.
struct OrientedMesh {
  /// Vertices and colors as they were; triangles in their order, less the dropped ones.
  TriangleMesh mesh;
  std::uint64_t degenerate_dropped = 0;  ///< triangles with a repeated vertex
  std::uint64_t duplicates_dropped = 0;  ///< triangles with the same three vertices as one that is kept
  std::uint64_t cancelled = 0;           ///< triangles with the same three vertices of which none is kept
  std::uint64_t turned = 0;              ///< triangles that run the other way now
  std::uint64_t components = 0;          ///< parts of the result that hang together by edges
  std::uint64_t patches = 0;             ///< parts that hang together by edges of exactly two triangles
  std::uint64_t non_orientable = 0;      ///< patches that have one side only, left as they were
  std::optional<Vec3> non_orientable_example;  ///< a vertex of the first such patch, metres
  bool closed = false;                         ///< the result is: see MeshDiagnosis::closed()
  bool interrupted = false;                    ///< by the progress; the mesh is then empty
};

/// Makes the orientation of a mesh consistent without moving, adding or splitting anything. Vertices at
/// identical coordinates count as one. Never fails; the time is that of sorting the edges and of one ray for
/// each closed part that is within another's box.
/// 1. Triangles with a repeated vertex are dropped.
/// 2. Of triangles with the same three vertices:
///    - In a component that is closed as it is, the sum of their signs is kept: opposite ones cancel, which
///      leaves all winding numbers as they are. If that would leave nothing of the component, one of each set
///      is kept: the surface was given twice.
///    - Elsewhere orientation may be wrong, so parity counts. Of an odd number one is kept. Sets of even
///    number
///      that hang together by edges are decided together: none is kept if that leaves fewer edges with an odd
///      number of triangles, such as for the walls between the elements of a solid; else one is, such as of a
///      duplicate in a sound mesh, or of a surface whose every triangle was given twice.
/// 3. Every patch, bounded by the edges that have not exactly two triangles, is made consistent in itself, by
///    turning fewer than half of its triangles, or half.
/// 4. A closed part (a patch closed in itself, or patches that are closed together) that is inside out by its
///    signed volume is turned, unless it is inside another one: there it may be meant as a cavity. Parts
///    inside others keep what step 3 gave them, or turn with the outermost one around them, so that the
///    mirror image of a solid with a cavity has its cavity too.
[[nodiscard]] OrientedMesh orient(const TriangleMesh& mesh, const Progress* progress = nullptr);

}  // namespace mesocell
