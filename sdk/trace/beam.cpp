#include "sdk/trace/beam.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdk/trace/tile_record.h"

namespace mesocell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Tiles of one slice that are looked at; a wider beam goes no further.
constexpr std::int32_t kMostTiles = 12;

using Voxels = std::array<std::int32_t, 3>;

/// floor(v / n) of a voxel 0 ≤ v < 2^22.
std::int32_t tile_of(const BeamGrid& grid, std::int32_t v, std::size_t a) {
  return std::int32_t((float(v) + 0.5f) * grid.inverse_resolution[a]);
}

/// The greatest plane on the beam's axis known up to which no ray meets a tile that is not empty; from
/// `plane`, which is one; infinite if no ray does at all.
double through_empty_tiles(const BeamGrid& grid, const Beam& beam, double plane) {
  const std::size_t k = beam.axis;
  for (;;) {
    // No ray is below this tile, mirrored, from the plane on.
    Voxels corner{}, tile{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double way = std::max(plane - beam.high[k], 0.0);
      const double least = a == k ? plane : beam.low[a] + way * beam.slope_low[a];
      if (!(least < grid.size[a])) return kInfinity;
      corner[a] = tile_of(grid, std::int32_t(std::max(least, 0.0)), a);
      tile[a] = beam.octant >> a & 1 ? corner[a] : grid.tiles[a] - 1 - corner[a];
    }
    const std::uint32_t record = grid.tile_records[grid.index(tile)];
    if (record >= kFullTile) return plane;
    const std::int32_t edge = std::int32_t(empty_edge(record, beam.octant));
    double next = kInfinity;
    for (std::size_t a = 0; a < 3; ++a) {
      // What is beyond the grid is empty too.
      if (corner[a] + edge >= grid.tiles[a]) continue;
      const double end = double((corner[a] + edge) * grid.resolution[a]);
      if (a == k) {
        next = std::min(next, end);
      } else if (beam.high[a] + (grid.size[k] - beam.low[k]) * beam.slope_high[a] >= end) {
        next = std::min(next, beam.low[k] + (end - beam.high[a]) / beam.slope_high[a]);
      }
    }
    if (next >= grid.size[k]) return kInfinity;
    if (!(next >= plane + 1)) return plane;
    plane = next;
  }
}

/// Parts first…last of an axis, as bits of a block of 4 × 4 × 4.
Bits64 parts_along(std::size_t axis, std::int32_t first, std::int32_t last) {
  const Bits64 of_axis = (Bits64{2} << last) - (Bits64{1} << first);  // four bits
  if (axis == 0) return of_axis * 0x1111111111111111;
  constexpr auto kSpread = [] {
    std::array<Bits64, 16> spread{};  // each bit to four
    for (std::size_t m = 0; m < 16; ++m)
      for (std::size_t b = 0; b < 4; ++b) spread[m] |= m >> b & 1 ? Bits64{0xf} << (4 * b) : 0;
    return spread;
  }();
  if (axis == 1) return kSpread[of_axis] * 0x0001000100010001;
  const Bits64 halves = kSpread[of_axis];  // each to sixteen
  return (halves & 0xf) * 0x1111 | (halves >> 4 & 0xf) * 0x11110000 | (halves >> 8 & 0xf) * 0x111100000000 |
         (halves >> 12 & 0xf) * 0x1111000000000000;
}

/// Whether all parts that meet the box of voxels low…high are empty. What is beyond the grid is.
bool parts_are_empty(const BeamGrid& grid, Voxels low, Voxels high) {
  Voxels first{}, last{};
  std::int32_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(low[a], 0);
    high[a] = std::min(high[a], std::int32_t(grid.size[a]) - 1);
    if (low[a] > high[a]) return true;
    first[a] = tile_of(grid, low[a], a);
    last[a] = tile_of(grid, high[a], a);
    count *= last[a] - first[a] + 1;
  }
  if (count > kMostTiles) return false;
  Voxels t{};
  for (t[2] = first[2]; t[2] <= last[2]; ++t[2])
    for (t[1] = first[1]; t[1] <= last[1]; ++t[1])
      for (t[0] = first[0]; t[0] <= last[0]; ++t[0]) {
        const std::uint32_t record = grid.tile_records[grid.index(t)];
        if (record < kFullTile) continue;
        Bits64 parts = grid.occupied_parts[record - kFullTile];
        for (std::size_t a = 0; a < 3; ++a) {
          const std::int32_t begin = t[a] * grid.resolution[a];
          const std::int32_t from = std::max(low[a] - begin, 0);
          const std::int32_t to = std::min(high[a] - begin, grid.resolution[a] - 1);
          parts &= parts_along(a, from >> grid.part_shift[a], to >> grid.part_shift[a]);
        }
        if (parts != 0) return false;
      }
  return true;
}

/// As through_empty_tiles(), but through empty parts of tiles too.
double through_empty_parts(const BeamGrid& grid, const Beam& beam, double plane) {
  const std::size_t k = beam.axis;
  const double slice = double(std::int64_t{1} << grid.part_shift[k]);
  for (;;) {
    const double next = (std::floor(plane / slice) + 1) * slice;
    Voxels low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      double least = plane, most = next;
      if (a != k) {
        least = beam.low[a] + std::max(plane - beam.high[k], 0.0) * beam.slope_low[a];
        most = beam.high[a] + (next - beam.low[k]) * beam.slope_high[a];
      }
      if (!(least < grid.size[a])) return kInfinity;
      // A coordinate on an integer is of the voxels on both sides.
      least = std::max(least, 0.0) - 0x1p-10;
      most = std::clamp(most, -1.0, grid.size[a]) + 0x1p-10;
      // Above -1, where adding 1 makes a floor of what is cut off.
      low[a] = std::int32_t((beam.octant >> a & 1 ? least : grid.size[a] - most) + 1) - 1;
      high[a] = std::int32_t((beam.octant >> a & 1 ? most : grid.size[a] - least) + 1) - 1;
    }
    if (!parts_are_empty(grid, low, high)) return plane;
    plane = through_empty_tiles(grid, beam, next);
    if (!(plane < grid.size[k])) return kInfinity;
  }
}

}  // namespace

double empty_until(const BeamGrid& grid, const Beam& beam) {
  const double plane = through_empty_tiles(grid, beam, std::max(beam.low[beam.axis], 0.0));
  return std::max(plane - beam.high[beam.axis], 0.0);
}

BeamStart find_start(const BeamGrid& grid, const Beam& beam) {
  const std::size_t k = beam.axis;
  double plane = through_empty_tiles(grid, beam, std::max(beam.low[k], 0.0));
  if (plane < grid.size[k]) plane = through_empty_parts(grid, beam, plane);
  if (!(plane < grid.size[k])) return {.misses = true};
  // Half a voxel before the plane rays are in the middle of nothing.
  return {.axis = unsigned(k), .plane = beam.octant >> k & 1 ? plane - 0.5 : grid.size[k] - plane + 0.5};
}

}  // namespace mesocell
