#pragma once

#include <functional>
#include <string>

#include "format/cell_object.h"
#include "sdk/core/rng.h"

namespace mesocell::test {

/// A cell object of a tile recipe, one metre a voxel, its corner at the origin, whose instances are INSIDE at
/// random with a given share; instances that leave the grid never are.
[[nodiscard]] CellObject random_object(Rng& rng, const std::string& recipe, const Index3& tiles,
                                       double inside_share);

/// Tiles of `edge`³ voxels, one metre a voxel, the corner at the origin, each tile one cell: INSIDE where `inside`
/// says, which is given the tile's place.
[[nodiscard]] CellObject make_blocks(
    const Index3& tiles, std::uint32_t edge,
    const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t)>& inside);

}  // namespace mesocell::test
