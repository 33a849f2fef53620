#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdk/membership/open_solid.h"
#include "sdk/membership/scanline.h"

namespace mesocell {

/// Decides a row of voxels by the generalized winding number, rounded. `mask`: the bits that make it solid.
/// `crossings`: of the row, sorted by x; `x_end`: its length. Intervals that are inside are added to `out`.
/// Returns how many voxels were nearly a tie.
std::uint64_t decide_open_row(const OpenSolid& open, std::span<const Scanline::Crossing> crossings,
                              std::uint32_t y, std::uint32_t z, std::uint32_t x_end, std::int32_t mask,
                              std::vector<Interval>& out);

}  // namespace mesocell
