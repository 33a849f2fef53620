#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "format/api.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// What can be said of a mesh's topology. Vertices at identical coordinates count as one.
struct MeshDiagnosis {
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  ///< with a repeated vertex; left out of all that follows
  std::uint64_t boundary_edges = 0;        ///< with one triangle
  std::uint64_t non_manifold_edges = 0;    ///< with three or more
  std::uint64_t misoriented_edges = 0;     ///< with two that run along it in the same direction
  std::uint64_t unbalanced_edges = 0;      ///< not run along equally often in both directions
  std::optional<Vec3> example;             ///< midpoint of the first unbalanced edge, metres

  /// Every edge is run along equally often in both directions, so the winding number of each point off the
  /// surface is a well-defined whole number.
  [[nodiscard]] bool closed() const { return triangles > degenerate_triangles && unbalanced_edges == 0; }
};

[[nodiscard]] MeshDiagnosis diagnose(const TriangleMesh& mesh);

/// One sentence for people: what keeps the mesh from being closed, with counts and a place.
[[nodiscard]] std::string describe(const MeshDiagnosis& diagnosis);

}  // namespace mesocell
