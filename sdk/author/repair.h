#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// How far a mesh that is not closed may be repaired; each includes what is before it.
enum class Repair : std::uint8_t {
  kStrict,   ///< not at all: it is refused
  kOrient,   ///< triangles are turned and duplicates dropped, see orient(); it is refused if that does not
             ///< close it
  kWinding,  ///< what is inside is decided by the generalized winding number [Jacobson 2013]
};

/// What decided what is inside.
enum class RepairRung : std::uint8_t { kNone, kOrient, kWinding };

struct RepairOptions {
  Repair repair = Repair::kWinding;
};

/// What was done to a mesh.
struct RepairReport {
  RepairRung rung = RepairRung::kNone;  ///< kNone: the mesh was closed and stayed as it is
  std::uint64_t turned_triangles = 0;   ///< to run the other way
  std::uint64_t dropped_triangles = 0;  ///< duplicates, and those with a repeated vertex
  std::uint64_t boundary_edges = 0;     ///< that were left, as often as the boundary runs along them
  std::uint64_t unsure_voxels = 0;      ///< of a winding number from 0.4 to 0.6; known once voxels are
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
/// Errors: kInvalidInput with the diagnosis if the mesh may not be repaired, kCancelled.
[[nodiscard]] Result<RepairedMesh> repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {},
                                               const Progress* progress = nullptr);

}  // namespace mesocell
