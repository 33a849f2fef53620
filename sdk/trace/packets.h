#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sdk/core/ray.h"
#include "sdk/trace/beam.h"
#include "sdk/trace/caster.h"

/// Exact tracing of many rays at once by the processor's vector instructions, chosen when the program runs.
///
/// Rays are walked in double precision, one a lane. Where rounding leaves open which voxel comes next, which
/// is told by a bound on its error, a ray is left *undecided* and must be traced by exact arithmetic; of rays
/// that do not aim at edges of voxels that is less than one in 2^30. So all instruction sets, and the exact
/// walk, find the same hits to the last bit.
namespace mesocell {

/// What the walk looks up; the tables are those of CellScene and are kept by it.
struct PacketScene : BeamGrid {
  std::array<double, 3> corner{};                      ///< minimum corner of the grid, metres
  double voxel_edge = 1;                               ///< metres
  std::array<std::int32_t, 3> pad{}, end{}, blocks{};  ///< see TileBlocks
  std::int32_t id_bits = 0, edge_bits = 0, voxel_shift = 0, block_count = 0, brick_count = 0, set_words = 0;
  bool flat = false;  ///< see TileBlocks
  /// Whether tiles are cubes of 16, 32, 64, … voxels, of which a step takes less time.
  bool cubes = false;
  std::int32_t log2_resolution = 0;  ///< of cubes
  const std::uint8_t* parts = nullptr;
  const std::uint32_t* block_records = nullptr;
  const std::uint8_t* bricks = nullptr;
  const std::uint32_t* sets = nullptr;
  const std::uint32_t* labels = nullptr;  ///< of piece ids
};

/// Rays that a packet call takes at most.
constexpr std::size_t kPacketRays = 64;

/// Whether this machine has vector instructions that are worth it.
[[nodiscard]] bool packets_supported();

/// Traces up to kPacketRays rays. A bit is set in the result for each ray that is undecided, whose hit is not
/// written. `steps`: the number of steps taken is added to it, unless it is null.
[[nodiscard]] std::uint64_t trace_packets(const PacketScene& scene, std::span<const Ray> rays,
                                          StreamHit* hits, std::uint64_t* steps);

}  // namespace mesocell
