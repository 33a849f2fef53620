#pragma once

#include <cstdint>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/solid.h"
#include "sdk/membership/solid_shape.h"

namespace mesocell MESOCELL_API {

struct MembershipOptions {
  MembershipRule rule = MembershipRule::kCentre;
  SolidRule solid = SolidRule::kNonzero;
  unsigned threads = 0;                              ///< 0: the machine's; the result does not depend on it
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  ///< of working memory for tiles that the surface meets
};

/// What the voxelization saw.
struct MembershipReport {
  std::uint64_t inside_voxels = 0;  ///< of the grid, whatever the tile has there
  std::uint64_t mixed_tiles = 0;    ///< tiles with voxels inside and voxels outside
  std::uint64_t boundary_edges =
      0;  ///< of the mesh, as often as its boundary runs along them; 0 if it is closed
  std::uint64_t unsure_voxels = 0;  ///< whose winding number 0.1 more or less would turn
};

/// Tags every cell instance by a rule. [spec 4.3; Nürnberg 2011, 3.1.5]
/// - `mesh`: in voxel units of the grid, coordinates below 2^40 in magnitude; if it is not closed (see
/// diagnose()), what is inside is decided by its generalized winding number, and takes longer near its
///   boundary
/// - `tiles`: of the grid; voxels beyond it count as not inside, so an instance that leaves it is never
/// INSIDE Errors: kLimit, kCancelled.
[[nodiscard]] Result<MembershipMap> compute_membership(const TriangleMesh& mesh, const Index3& tiles,
                                                       const TileMap& tile,
                                                       const MembershipOptions& options = {},
                                                       MembershipReport* report = nullptr,
                                                       const Progress* progress = nullptr);

/// The same for a shape that is no mesh: a voxel is inside if its centre is. `grid` is in the shape's metres.
/// Errors: kUsage (another rule than kCentre), kLimit, kCancelled.
[[nodiscard]] Result<MembershipMap> compute_membership(const SolidShape& shape, const GridLayout& grid,
                                                       const TileMap& tile,
                                                       const MembershipOptions& options = {},
                                                       MembershipReport* report = nullptr,
                                                       const Progress* progress = nullptr);

}  // namespace mesocell
