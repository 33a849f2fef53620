#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sdk/trace/octant_cubes.h"

namespace mesocell {

/// Rays that go nearly the same way, as bounds: in voxels, and mirrored on axes on which they fall, so that
/// all go up. A ray has origin[a] in [low[a], high[a]] and direction[a] / direction[axis] in [slope_low[a],
/// slope_high[a]].
struct Beam {
  unsigned axis = 0;    ///< on which all rays move
  unsigned octant = 0;  ///< of the rays: bit a is set if they rise on axis a
  std::array<double, 3> low{}, high{}, slope_low{}, slope_high{};
};

/// What a beam looks up: see CellScene.
struct BeamGrid {
  std::array<std::int32_t, 3> tiles{}, resolution{};
  std::array<std::int32_t, 3> part_shift{};  ///< parts of tiles have 1 << part_shift voxels on an axis
  std::array<double, 3> size{};              ///< of the grid, voxels
  std::array<float, 3> inverse_resolution{};
  const std::uint32_t* tile_records = nullptr;
  const Bits64* occupied_parts = nullptr;  ///< of sets of pieces, not mirrored

  [[nodiscard]] std::size_t index(const std::array<std::int32_t, 3>& tile) const {
    return std::size_t(tile[0]) +
           std::size_t(tiles[0]) * (std::size_t(tile[1]) + std::size_t(tiles[1]) * std::size_t(tile[2]));
  }
};

/// Where the rays of a beam may begin, besides at their origins: they are known to meet nothing before they
/// pass `plane`, in voxels and not mirrored, on `axis`; no such place is known if that is 3.
struct BeamStart {
  unsigned axis = 3;
  double plane = 0;
  bool misses = false;  ///< no ray hits anything
};

/// How far on the beam's axis, in voxels from its origins, no ray meets a tile that is not empty; infinite if
/// none does at all.
[[nodiscard]] double empty_until(const BeamGrid& grid, const Beam& beam);

/// Finds where the rays of a beam may begin: through empty tiles, then through empty parts of tiles too.
[[nodiscard]] BeamStart find_start(const BeamGrid& grid, const Beam& beam);

}  // namespace mesocell
