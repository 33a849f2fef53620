#pragma once

#include <cstdint>
#include <span>

#include "format/cell_object.h"
#include "sdk/core/ray.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// The exact hit by its definition [spec 4.9], slow and obvious: from voxel to voxel, each looked up in the
/// object's maps, nothing skipped.
[[nodiscard]] StreamHit walk_to_hit(const CellObject& object, const Ray& ray);

/// Whether two hits say the same: element, label and face, and t to a millionth of a voxel.
[[nodiscard]] bool same_hit(const StreamHit& a, const StreamHit& b, double voxel_edge);

}  // namespace mesocell
