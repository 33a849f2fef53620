#pragma once

#include <span>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/tiles/tile_spec.h"

namespace mesocell {

/// Where a tile lies in the space of meshes that become its cells.
struct TilePlacement {
  Vec3 origin;            ///< minimum corner of the tile, metres
  double voxel_edge = 0;  ///< metres
};

/// The tile around a box: centred on it, its longest side `size` metres; or as small as leaves a voxel of
/// room on each side of the box if `size` is 0. The box is not empty.
[[nodiscard]] TilePlacement place_tile(const Box3& box, const Index3& resolution, double size);

/// The parts of a mesh that have no vertex in common, in the order of their first triangles; vertices at
/// identical coordinates count as one.
[[nodiscard]] std::vector<TriangleMesh> split_into_parts(const TriangleMesh& mesh);

/// Makes a tile of closed meshes, one a cell, in order; what sticks out of the tile comes in again on its
/// other side. A voxel belongs to a cell if its centre is inside, as by MembershipRule::kCentre; where
/// several claim it, to the first, and of a cell's own images to the one moved least in z, then y, then x;
/// the report counts such voxels, and meshes that got none. Errors: kUsage (placement), kInvalidInput (a mesh
/// that is not closed, with its number and diagnosis; no voxel inside any), kLimit (more than 65 535 meshes,
/// or one larger than 100 tiles), kCancelled.
[[nodiscard]] Result<TileMap> make_mesh_tile(std::span<const TriangleMesh> cells, const Index3& resolution,
                                             const TilePlacement& placement, unsigned threads = 0,
                                             TileReport* report = nullptr,
                                             const Progress* progress = nullptr);

}  // namespace mesocell
