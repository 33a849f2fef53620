#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/author/repair.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/diagnose.h"
#include "sdk/membership/solid.h"
#include "sdk/membership/solid_shape.h"

namespace mesocell MESOCELL_API {

/// How the grid is laid over the mesh. [spec 4.1]
struct GridOptions {
  std::uint32_t tiles = 16;  ///< tiles along the longest side; used if tile_size is not set
  std::optional<double> tile_size = std::nullopt;  ///< edge of a tile along its longest axis, metres
  std::optional<Box3> box = std::nullopt;          ///< covered instead of the mesh's bounding box
  std::uint64_t max_tiles = 1u << 26;              ///< more tiles than this are refused (kLimit)
};

/// Lays the grid over the box of a mesh or of another shape. Errors: kUsage, kInvalidInput (box of no size or of one too small for its coordinates),
/// kLimit.
[[nodiscard]] Result<GridLayout> lay_grid(const Box3& mesh_box, const Index3& tile_resolution,
                                          const GridOptions& options);

struct AuthorOptions {
  GridOptions grid = {};
  RepairOptions repair = {};
  SolidRule solid = SolidRule::kNonzero;  ///< a thickness needs kNonzero, as what it makes overlaps
  MembershipRule rule = MembershipRule::kCentre;
  unsigned threads = 0;  ///< 0: the machine's; the result does not depend on it
};

/// What authoring did and what it cost.
struct AuthorReport {
  double voxelize_seconds = 0;  ///< diagnosis, inside/outside and tags
  double surface_seconds = 0;   ///< normals and colors
  double mesh_volume = 0;  ///< metres³, of the basic mesh as repaired, absolute; 0 if it is not closed or was
                           ///< given a thickness
  double inside_volume = 0;     ///< metres³, of the voxels of INSIDE instances
  RepairReport repair;
  MeshDiagnosis diagnosis;  ///< of the mesh that was given, see repair_mesh(); set on failure, too
  std::vector<Warning> warnings;
};

/// Makes a cell object from a mesh and a tile. A mesh that is not closed is repaired as far as the options
/// allow, and the report says how. Errors: those of repair_mesh(); kInvalidInput if the mesh has no extent or
/// is open and has no cell inside; kUsage (a thickness with rule conservative or another solid than kNonzero); kLimit; kCancelled.
[[nodiscard]] Result<CellObject> author_cell_object(const TriangleMesh& mesh, TileMap tile,
                                                    const AuthorOptions& options,
                                                    AuthorReport* report = nullptr,
                                                    const Progress* progress = nullptr);

/// Makes a cell object from a shape that is no mesh, without one in between; of the options, those of repair
/// and `solid` mean nothing. Errors: kUsage (another rule than kCentre), kInvalidInput (nothing is inside of
/// the shape), kLimit, kCancelled.
[[nodiscard]] Result<CellObject> author_cell_object(const SolidShape& shape, TileMap tile,
                                                    const AuthorOptions& options,
                                                    AuthorReport* report = nullptr,
                                                    const Progress* progress = nullptr);

}  // namespace mesocell
