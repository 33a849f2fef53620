#pragma once

#include <array>

#include "sdk/core/vec.h"

/// How far a box is from what is around it, for bounds.
namespace mesocell {

/// Squared distance of two closed boxes, 0 where they meet.
[[nodiscard]] double squared_distance(const Box3& a, const Box3& b);

/// Bounds the distance of a closed triangle and a closed box from below, coordinates in voxels: by the gap
/// between them along some directions, those that tell slivers from their boxes among them.
[[nodiscard]] double distance_bound(const std::array<Vec3, 3>& t, const Box3& box);

}  // namespace mesocell
