#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/cell_object.h"

/// Rules of the source [Nürnberg 2011] as it states them, for tests that show where they give the wrong
/// answer.
namespace mesocell::test {

/// The faces of a tile that a voxel touches: bits 0, 1 for x low, high, 2, 3 for y, 4, 5 for z. [figure 4.3]
inline std::uint8_t face_code(const Index3& n, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return std::uint8_t((x == 0) | (x + 1 == n[0]) << 1 | (y == 0) << 2 | (y + 1 == n[1]) << 3 | (z == 0) << 4 |
                      (z + 1 == n[2]) << 5);
}

/// The split cell map after some passes: voxels take over the face codes of those of their 26 neighbours that
/// are of the same cell, twice a pass. [algorithms 4.1, 4.2]
inline std::vector<std::uint8_t> split_cells_by_passes(const Index3& n,
                                                       const std::vector<std::uint32_t>& cells,
                                                       std::uint32_t passes) {
  const auto index = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    return std::size_t(x + n[0] * (y + n[1] * z));
  };
  std::vector<std::uint8_t> from(cells.size()), to(cells.size());
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t y = 0; y < n[1]; ++y)
      for (std::uint32_t x = 0; x < n[0]; ++x) from[index(x, y, z)] = face_code(n, x, y, z);
  for (std::uint32_t run = 0; run < 2 * passes; ++run, from.swap(to))
    for (std::int64_t z = 0; z < n[2]; ++z)
      for (std::int64_t y = 0; y < n[1]; ++y)
        for (std::int64_t x = 0; x < n[0]; ++x) {
          std::uint8_t code = 0;
          const std::uint32_t cell = cells[index(x, y, z)];
          for (int d = 0; d < 27 && cell != 0; ++d) {
            const std::int64_t u = x + d % 3 - 1, v = y + d / 3 % 3 - 1, w = z + d / 9 - 1;
            if (u < 0 || v < 0 || w < 0 || u >= n[0] || v >= n[1] || w >= n[2]) continue;
            if (cells[index(u, v, w)] == cell) code = std::uint8_t(code | from[index(u, v, w)]);
          }
          to[index(x, y, z)] = code;
        }
  return from;
}

/// Where the tile of another split cell of a cell is, relative to the tile of the one at hand, by their face
/// codes. [algorithm 4.7, row 17 as printed]
inline std::array<std::int32_t, 3> shift_by_face_codes(std::uint8_t current, std::uint8_t neighbour) {
  const int directions = current | neighbour;
  std::int32_t x = 0, y = 0;
  const std::int32_t z = 0;
  if ((directions & 3) == 3) x = 2 * (current & 3) - 3;
  if ((directions >> 2 & 3) == 3) y = 2 * (current >> 2 & 3) - 3;
  if ((directions >> 4 & 3) == 3) x = 2 * (current >> 4 & 3) - 3;
  return {x, y, z};
}

/// The face code of each piece of a tile: of all its voxels.
inline std::vector<std::uint8_t> face_codes(const TileMap& tile) {
  std::vector<std::uint8_t> codes(tile.pieces.size());
  const Index3& n = tile.resolution;
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t y = 0; y < n[1]; ++y)
      for (std::uint32_t x = 0; x < n[0]; ++x)
        if (const std::uint32_t id = tile.id(tile.voxel_index(x, y, z)))
          codes[id - 1] = std::uint8_t(codes[id - 1] | face_code(n, x, y, z));
  return codes;
}

}  // namespace mesocell::test
