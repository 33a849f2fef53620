#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/diagnose.h"

namespace mesocell MESOCELL_API {

/// How far a mesh that is not closed may be repaired.
enum class Repair : std::uint8_t {
  kStrict,   ///< not at all: it is refused
  kOrient,   ///< cracks are stitched, triangles turned and duplicates dropped, see stitch() and orient(); it
             ///< is refused if that does not close it
  kWinding,  ///< if that does not close it, the generalized winding number decides what is inside
             ///< [Jacobson 2013]
  kWrap,     ///< if that does not close it, it is replaced by its alpha wrap; no winding number is asked
  kAuto,     ///< the first of them that suffices: as kWinding, and as kWrap, if there is a wrapper, where more
             ///< than a tenth of the edges have three triangles or more, or no cell is inside by the winding
             ///< number. A wrap that has no cell inside either is no solid.
};

/// What decided what is inside.
enum class RepairRung : std::uint8_t { kNone, kOrient, kWinding, kWrap, kThicken };

/// "none", "orient", "winding", "wrap" or "thicken".
[[nodiscard]] const char* rung_name(RepairRung rung);

/// A maker of closed surfaces around meshes: alpha_wrap(), which is under another licence, so whoever wants
/// it links it. Lengths in metres.
using MeshWrapper = std::function<Result<TriangleMesh>(const TriangleMesh& mesh, double alpha, double offset,
                                                       const Progress* progress)>;

struct RepairOptions {
  Repair repair = Repair::kAuto;
  double stitch_tolerance = 0;  ///< metres; 0: 1e-5 of the diagonal of the mesh's box
  /// Metres; not 0: the open components that stitching leaves are replaced by what is within half of it of
  /// them, see thicken(), and no winding number or wrap is needed. Refused with kStrict.
  double thickness = 0;
  MeshWrapper wrapper = nullptr;  ///< empty: kWrap is refused (kUsage)
  double wrap_alpha = 0;          ///< metres; 0: a twentieth of the diagonal of the mesh's box
  double wrap_offset = 0;         ///< metres; 0: a thirtieth of alpha
  unsigned threads = 0;           ///< 0: the machine's; the result does not depend on it
};

/// What was done to a mesh. Lengths in metres.
struct RepairReport {
  RepairRung rung = RepairRung::kNone;  ///< kNone: the mesh was closed and stayed as it is
  std::uint64_t stitched_edges = 0;     ///< boundary edges that were paired up
  std::uint64_t inserted_vertices = 0;  ///< that edges were cut at for that
  double stitch_tolerance = 0;          ///< that was used
  double largest_move = 0;              ///< of a vertex or an edge by stitching
  std::uint64_t turned_triangles = 0;   ///< to run the other way
  std::uint64_t dropped_triangles = 0;  ///< duplicates, and those with a repeated vertex
  std::uint64_t boundary_edges = 0;     ///< that were left, as often as the boundary runs along them
  std::uint64_t unsure_voxels = 0;      ///< of a winding number from 0.4 to 0.6; known once voxels are
  double thickness = 0;                 ///< that open components were given
  std::uint64_t thickened_triangles = 0;
  double wrap_alpha = 0, wrap_offset = 0;  ///< of the wrap
  double wrap_distance = 0;  ///< the farthest of the wrap's vertices and triangles' centres from the mesh
};

/// A remark that is no failure.
struct Warning {
  std::string id;
  std::string text;
};

/// A mesh brought as far as the options allow: to where it is closed, or at least of one mind about what is
/// outside.
struct RepairedMesh {
  std::optional<TriangleMesh> mesh;  ///< not set: the one that was given, as it is
  RepairReport report;
  std::vector<Warning> warnings;
};

/// Repairs a mesh on the way to a cell object; compute_membership() decides what is inside of what is left.
/// Stitching is first, as turning goes from triangle to triangle and so must find the seams closed.
/// - `found`: is given what is amiss with `mesh`, also on failure: edges alone if it is closed, else to
///   DiagnosisDepth::kGeometry
/// - errors: kInvalidInput with the diagnosis if the mesh may not be repaired, kUsage, those of thicken() and
///   of the wrapper, kCancelled
[[nodiscard]] Result<RepairedMesh> repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {},
                                               const Progress* progress = nullptr,
                                               MeshDiagnosis* found = nullptr);

}  // namespace mesocell
