#pragma once

#include <string>

#include "format/cell_object.h"
#include "sdk/core/rng.h"

namespace mesocell::test {

/// A cell object of a tile recipe, one metre a voxel, its corner at the origin, whose instances are INSIDE at
/// random with a given share; instances that leave the grid never are.
[[nodiscard]] CellObject random_object(Rng& rng, const std::string& recipe, const Index3& tiles,
                                       double inside_share);

}  // namespace mesocell::test
