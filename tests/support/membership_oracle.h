#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/triangle_mesh.h"

/// The definitions of membership, evaluated voxel by voxel. Slow and obvious.
namespace mesocell::test {

/// Whether each voxel of a grid is inside: the winding number of the mesh (voxel units) about its centre,
/// moved by (ε, ε², ε³), is not zero. Rays go up along z, one a voxel; x fastest.
[[nodiscard]] std::vector<bool> inside_by_definition(const TriangleMesh& mesh, const Index3& voxels);

/// Whether each voxel's closed box has a point in common with a closed triangle of the mesh (voxel units): by
/// exact clipping of the triangle to the box, in rational arithmetic.
[[nodiscard]] std::vector<bool> touched_by_definition(const TriangleMesh& mesh, const Index3& voxels);

/// Whether two triangles have a point in common that is not on the vertex or the edge that they share by
/// corners at the same places: by exact clipping of the one to the other, in rational arithmetic. Neither may
/// be degenerate; false if they share three corners.
[[nodiscard]] bool triangles_intersect_by_definition(const std::array<Vec3, 3>& a,
                                                     const std::array<Vec3, 3>& b);

/// The tag of every instance, home tile x fastest, then cell: every voxel of every instance is looked at.
[[nodiscard]] std::vector<Tag> tags_by_definition(const std::vector<bool>& inside, const Index3& tiles,
                                                  const TileMap& tile, const std::vector<bool>& touched = {});

/// How many tags of a map differ from such a list.
[[nodiscard]] std::uint64_t wrong_tags(const MembershipMap& map, const std::vector<Tag>& expected);

/// A tile in which each voxel is a cell of its own, so that tags tell of every voxel; at most 65 535 voxels.
[[nodiscard]] TileMap single_voxel_cells(const Index3& resolution);

/// Of such a tile's map, whether each voxel of the grid is INSIDE; x fastest.
[[nodiscard]] std::vector<bool> inside_voxels(const MembershipMap& map, const TileMap& tile);

/// Voxels of a grid along each axis.
[[nodiscard]] Index3 voxels_of(const Index3& tiles, const TileMap& tile);

/// A mesh in the voxel units of a grid.
[[nodiscard]] TriangleMesh in_voxels(const TriangleMesh& mesh, const GridLayout& grid);

}  // namespace mesocell::test
