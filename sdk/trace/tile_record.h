#pragma once

#include <cstdint>

/// What is known of a tile, in four bytes. One that has no INSIDE voxels has a digit of four bits for each
/// octant, that of octant 7 below 15: the cube of empty_edge(digit) tiles in the octant's directions is
/// empty. Others are kFullTile + the number of their set of pieces.
namespace mesocell {

constexpr std::uint32_t kFullTile = 0xf0000000;
constexpr std::uint32_t kLastDigit = 14;

/// Edge, in tiles: 1, 2, 3, 5, 7, 11, 15, 23, 31, … 255.
constexpr std::uint32_t empty_edge(std::uint32_t digit) { return ((2 | (digit & 1)) << (digit >> 1)) - 1; }

/// Of a record below kFullTile.
constexpr std::uint32_t empty_edge(std::uint32_t record, unsigned octant) {
  return empty_edge(record >> (4 * octant) & 15);
}

}  // namespace mesocell
