#pragma once

#include <cstdint>
#include <memory>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// How the step of a linear search is chosen.
enum class LinearStep : std::uint8_t { kFixed, kByAngle };

/// The source's search: samples every `step` tile edges from where the ray enters the grid, empty tiles
/// skipped, then bisection to 1/64 voxel between the last sample outside and the first inside. What lies
/// between two samples is missed. [spec 4.9; Nürnberg 2011, 3.2.1] `step` in (0, 1].
///
/// kByAngle: the source says that "the initial step size of the linear search highly depends on the angle
/// between the shooting ray and the basic mesh's surface normal", lest grazing rays miss cells, and gives no
/// formula [Nürnberg 2011, 3.2.2]. Here it is `step` times the cosine of that angle, at least kLeastCosine,
/// so that rays nearly along the surface get the finest step. Tracing knows no basic mesh: the surface is
/// where the ray comes from outside the grid or out of empty tiles, its normal that of the tile's face there.
/// The samples begin anew at each such place, as the source's do wherever it draws the mesh. A ray that
/// begins between cells has the whole step up to the first such place.
[[nodiscard]] std::unique_ptr<Caster> make_linear_caster(const CellObject& object, double step,
                                                         LinearStep rule = LinearStep::kFixed);

/// The least cosine that shortens a step: 1/16, the angle 86.4°.
inline constexpr double kLeastCosine = 1.0 / 16;

}  // namespace mesocell
