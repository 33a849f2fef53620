#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/cell_object.h"

/// How far a ray may go at once: cubes of free entries that reach from an entry in the directions of one
/// octant. A ray only moves on, so what lies behind it does not bound its step as it does by distances.
///
/// Octants are numbered by the axes on which the ray rises: bit a is set if it does on axis a.
namespace mesocell {

/// A block of 4 × 4 × 4 entries, a bit each: entry (x, y, z) is bit x + 4·y + 16·z.
using Bits64 = std::uint64_t;

/// The block seen from the other side on the axes on which an octant falls.
[[nodiscard]] Bits64 mirrored(Bits64 block, unsigned octant);

/// For each entry of a block the edge, in entries, of the largest cube upward from it that is free, where
/// what lies beyond the block is free too: 0 if the entry itself is not, 4 if all above it is.
[[nodiscard]] std::array<std::uint8_t, 64> upward_cubes(Bits64 free);

/// For each entry of a grid the edge of the largest cube in an octant's directions that is free, at most 255,
/// where what lies beyond the grid is free. `free`: 0 or not, x fastest.
[[nodiscard]] std::vector<std::uint8_t> octant_cubes(const std::vector<std::uint8_t>& free,
                                                     const Index3& size, unsigned octant);

}  // namespace mesocell
