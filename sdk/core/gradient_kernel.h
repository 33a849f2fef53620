#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/api.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// A voxel near another, and what it adds to a normal there if it is outside.
struct KernelVoxel {
  std::array<std::int32_t, 3> offset{};
  Vec3 pull;  ///< the offset, times a weight
};

/// The 256 voxels at most four away. Weights fall smoothly to 0 just beyond: (1 - (d / 4.5)²)². A normal
/// summed so is within 2° RMS of that of a sphere of 8 to 64 voxels; a smaller radius sees the steps of
/// voxels, a larger one rounds off more of the edges.
[[nodiscard]] const std::vector<KernelVoxel>& gradient_kernel();

}  // namespace mesocell
