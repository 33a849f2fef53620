#pragma once

#include <memory>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// Distance stepping as engines do it, in single precision: from a point the ray goes on by the distance to
/// the nearest of those sides that the ray goes to of the known box of voxels around it that are of the same
/// instance, or of empty tiles, along any axis, and by kDistanceThreshold where that is less. It ends at the
/// first point in a voxel of an INSIDE instance. [sphere tracing, Hart 1996]
///
/// Approximate: the hit is up to the threshold behind the true one, what the ray cuts off by less may be
/// missed, most of it where rays graze, and so may what float rounding moves a point across. A ray along a
/// wall nearer than the threshold takes the shortest steps. Never a hit in a voxel that is not INSIDE.
[[nodiscard]] std::unique_ptr<Caster> make_distance_caster(const CellObject& object);

/// The least step, voxels along the axis that the ray goes along most.
inline constexpr float kDistanceThreshold = 1.0F / 32;

}  // namespace mesocell
