#pragma once

#include <cstdint>
#include <vector>

#include "format/cell_object.h"

/// Chebyshev distances: how far one can go from a voxel or a tile in every direction at once.
namespace mesocell {

/// Whether a grid ends at its border or goes on at the other side.
enum class Border : std::uint8_t { kOpen, kWrapped };

/// Distances to the nearest entry that is 0, at most 255, in place: `distance` holds 0 or 255, x fastest.
/// What lies beyond an open border is not 0.
void chebyshev_transform(std::vector<std::uint8_t>& distance, const Index3& size, Border border);

/// For each voxel of a tile the greatest r ≤ 255 such that all voxels up to Chebyshev distance r, across the
/// tile's border too, are of the same cell instance, or empty if it is.
[[nodiscard]] std::vector<std::uint8_t> instance_reach(const TileMap& tile);

}  // namespace mesocell
