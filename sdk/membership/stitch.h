#pragma once

#include <cstdint>

#include "format/api.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

struct StitchOptions {
  /// Metres; not above 0: 1e-5 of the diagonal of the mesh's box.
  double tolerance = 0;
};

/// A mesh without the cracks that are narrower than a tolerance, and what was done to it.
struct StitchedMesh {
  /// Vertices, colors and triangles in their order, some vertices moved; a triangle that was cut has its
  /// first piece in its place and the others behind all triangles.
  TriangleMesh mesh;
  double tolerance = 0;                 ///< that was used, metres
  std::uint64_t stitched_edges = 0;     ///< boundary edges that have a partner now
  std::uint64_t inserted_vertices = 0;  ///< existing vertices that boundary edges were cut at
  /// The farthest that a vertex was moved, or that an edge was bent to reach a vertex, metres; at most the
  /// tolerance.
  double largest_move = 0;
  bool interrupted = false;  ///< by the progress; the mesh is then as it was
};

/// Closes cracks: pairs up boundary edges, those of one triangle alone, that run along each other within the
/// tolerance, by moving the ends of one onto those of the other. Where an edge runs along several, it is cut
/// at their vertices first. Only vertices of boundary edges that find a partner are moved, each onto another
/// that is no farther than the tolerance; all that become one are within it of each other. About a vertex the
/// tolerance is a quarter of the shortest edge there if that is less, so no edge loses its length. Which way
/// triangles run does not matter, though of several partners one that runs the other way is taken; so this
/// comes before orient(), which then makes both sides of a seam agree. Vertices at identical coordinates
/// count as one, and so do triangles with the same vertices. A mesh without boundary edges is left as it is,
/// to the bit. The result does not depend on threads. Never fails; a mesh made to take long, of more
/// neighbours than 256 times its boundary edges, is not stitched any further.
[[nodiscard]] StitchedMesh stitch(const TriangleMesh& mesh, const StitchOptions& options = {},
                                  const Progress* progress = nullptr);

}  // namespace mesocell
