#pragma once

#include <memory>
#include <vector>

#include "format/result.h"
#include "sdk/core/transform.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// An asset in a scene. Many placements may share a caster, which costs them nothing but the transform.
struct Placement {
  const Caster* caster = nullptr;  ///< kept by reference; no scene itself
  Transform to_scene;              ///< from the asset's space; also with shear, or mirrored
};

/// A caster of the union of placed assets. Hits tell which placement by `Hit::placement`; instance and
/// element are in that asset's own terms, t and normals in the scene's. A ray is cast as it stands in the
/// asset's space, rounded to doubles; there the caster's own promises hold. Boxes that a ray does not meet,
/// or not before its nearest hit, are passed by; there is no further order, so the time grows with the number
/// of placements. Errors: kUsage (none, no caster, a transform that is singular or not finite).
[[nodiscard]] Result<std::unique_ptr<Caster>> make_scene(std::vector<Placement> placements);

}  // namespace mesocell
