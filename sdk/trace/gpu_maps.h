#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// A cell object's maps as the source lays them out for a GPU: an 8-bit texture of the tile that names each
/// voxel's split cell, and a texture of 4 × 32 bits with a texel for each tile that holds two bits for each
/// split cell. [Nürnberg 2011, 4.2-4.4]
///
/// A split cell is a piece: the part of a cell instance in one tile. Pieces are counted as the tile has them,
/// up to 64; the source allots eight to each of eight cells, by face code, so that two pieces with one code
/// would share a slot.
struct GpuMaps {
  /// What two bits say of a split cell, at bits 2·(k mod 16) of word k / 16, k from 0.
  enum Code : std::uint32_t { kOutside = 0, kInside = 1, kIntersected = 2, kUnset = 3 };

  Index3 resolution{};
  std::vector<std::uint8_t> split_cells;  ///< a voxel's split cell from 1, 0 where empty; x fastest
  /// For each split cell, which faces of the tile it touches: bits 0, 1 for x low, high, 2, 3 for y, 4, 5 for
  /// z.
  std::vector<std::uint8_t> face_codes;
  std::vector<std::uint16_t> cells;  ///< for each split cell the cell it is of, from 1
  Index3 tiles{};
  std::vector<std::array<std::uint32_t, 4>>
      tile_codes;  ///< x fastest; split cells that the tile does not have: kUnset

  [[nodiscard]] Code code(std::uint64_t tile, std::uint32_t split_cell) const {
    const std::uint32_t k = split_cell - 1;
    return Code(tile_codes[tile][k / 16] >> (2 * (k % 16)) & 3);
  }
};

/// Errors: kLimit if the tile has more than 64 pieces; it says how many.
[[nodiscard]] Result<GpuMaps> make_gpu_maps(const CellObject& object);

}  // namespace mesocell
