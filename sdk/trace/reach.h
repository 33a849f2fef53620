#pragma once

#include <cstdint>
#include <vector>

#include "format/cell_object.h"

namespace mesocell {

/// Chebyshev distances to the nearest entry of a grid that is 0, at most 255, in place: `distance` holds 0 or
/// 255, x fastest. What lies beyond the grid is not 0.
void chebyshev_transform(std::vector<std::uint8_t>& distance, const Index3& size);

}  // namespace mesocell
