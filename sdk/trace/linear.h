#pragma once

#include <memory>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// The source's search: samples every `step` tile edges from where the ray enters the grid, empty tiles
/// skipped, then bisection to 1/64 voxel between the last sample outside and the first inside. What lies
/// between two samples is missed. [spec 4.9; Nürnberg 2011, 3.2.1] `step` in (0, 1].
[[nodiscard]] std::unique_ptr<Caster> make_linear_caster(const CellObject& object, double step);

}  // namespace mesocell
