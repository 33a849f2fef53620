#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// What may be amiss with a mesh.
enum class MeshDefect : std::uint8_t {
  kRepeatedVertex,      ///< a triangle two of whose corners are at the same place
  kZeroArea,            ///< a triangle with three different corners on a line, exactly
  kBoundaryEdge,        ///< with one triangle
  kNonManifoldEdge,     ///< with three or more
  kMisorientedEdge,     ///< with two that run along it in the same direction
  kUnbalancedEdge,      ///< not run along equally often in both directions
  kNonManifoldVertex,   ///< whose triangles do not all hang together by edges at it
  kDuplicate,           ///< a triangle with the same vertices in the same order of turning as an earlier one
  kOppositeDuplicate,   ///< two with the same vertices and opposite orientation, paired as far as they go
  kUnreferencedVertex,  ///< a place of vertices that no triangle uses
  kInsideOut,           ///< a closed component of negative volume, not inside another
  kNested,              ///< a closed component inside another closed one, as a cavity or otherwise
  kSelfIntersection,    ///< two triangles that have more in common than vertices and edges
};
inline constexpr std::size_t kMeshDefectCount = 13;

/// How much to look at; each includes what is before it.
enum class DiagnosisDepth : std::uint8_t {
  kEdges,     ///< repeated vertices and edges: whether the mesh is closed
  kTopology,  ///< what takes sorting and exact signs alone: all but the following
  kGeometry,  ///< what is inside what, and self-intersections
};

/// What can be said of a mesh. Vertices at identical coordinates count as one, and triangles with a repeated
/// vertex are left out of all that follows them. Counts beyond the depth that was asked for are 0.
struct MeshDiagnosis {
  DiagnosisDepth depth = DiagnosisDepth::kEdges;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  ///< MeshDefect::kRepeatedVertex
  std::uint64_t boundary_edges = 0;
  std::uint64_t non_manifold_edges = 0;
  std::uint64_t misoriented_edges = 0;
  std::uint64_t unbalanced_edges = 0;
  std::uint64_t zero_area_triangles = 0;
  std::uint64_t non_manifold_vertices = 0;
  std::uint64_t duplicate_triangles = 0;
  std::uint64_t opposite_duplicates = 0;
  std::uint64_t unreferenced_vertices = 0;
  std::uint64_t components = 0;         ///< parts that hang together by edges
  std::uint64_t closed_components = 0;  ///< of them, those whose every edge is balanced
  /// Until DiagnosisDepth::kGeometry tells what is inside what, all closed components of negative volume.
  std::uint64_t inside_out_components = 0;
  std::uint64_t nested_components = 0;
  /// Of the nested: those that make the winding number in them 0, so that they are not solid.
  std::uint64_t cavities = 0;
  std::uint64_t self_intersections = 0;
  bool self_intersections_at_least = false;  ///< the search met a limit: there may be more
  std::optional<Vec3> example;               ///< midpoint of the first unbalanced edge, metres
  /// Of each defect found a place, metres, by MeshDefect: a vertex, an edge's midpoint, a triangle's
  /// centroid, a component's vertex of least x, or a point where the boxes of two triangles overlap.
  std::array<std::optional<Vec3>, kMeshDefectCount> examples;

  /// Every edge is run along equally often in both directions, so the winding number of each point off the
  /// surface is a well-defined whole number.
  [[nodiscard]] bool closed() const { return triangles > degenerate_triangles && unbalanced_edges == 0; }
};

struct DiagnoseOptions {
  DiagnosisDepth depth = DiagnosisDepth::kEdges;
  std::uint64_t max_self_intersections = 10'000;  ///< pairs to count
  unsigned threads = 0;                           ///< 0: the machine's; the result does not depend on it
};

/// Never fails. Cancelled, it returns early what it has, with self_intersections_at_least.
[[nodiscard]] MeshDiagnosis diagnose(const TriangleMesh& mesh, const DiagnoseOptions& options = {},
                                     const Progress* progress = nullptr);

/// One kind of defect that a mesh has.
struct MeshFinding {
  MeshDefect defect;
  const char* id;  ///< for machines, such as "boundary-edges"
  std::uint64_t count;
  bool at_least;  ///< there may be more
  std::optional<Vec3> example;
};

/// What was found, in the order of MeshDefect; nothing with a count of 0.
[[nodiscard]] std::vector<MeshFinding> findings(const MeshDiagnosis& diagnosis);

/// For people, such as "3 boundary edges, the first near (0.5, 0, 1)".
[[nodiscard]] std::string describe(const MeshFinding& finding);

/// One sentence for people: what keeps the mesh from being closed, with counts and a place.
[[nodiscard]] std::string describe(const MeshDiagnosis& diagnosis);

}  // namespace mesocell
