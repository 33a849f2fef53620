#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "format/api.h"
#include "sdk/core/ray.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

/// How one method's first hits differ from exact tracing of the same asset. Depth errors and angles are over
/// the rays that both hit; an angle, a cell and a voxel only where both know theirs.
struct TracingError {
  /// What a method that does not know cells or voxels gives as a hit's label or as an element's coordinates.
  static constexpr std::uint32_t kUnknownLabel = 0xffffffff;
  static constexpr std::int32_t kUnknownElement = -1;

  std::uint64_t rays = 0, hits = 0;  ///< rays compared, and how many exact tracing hits
  std::uint64_t missed = 0;          ///< hit exactly, missed by the method
  std::uint64_t false_hits = 0;      ///< hit by the method alone
  std::uint64_t late = 0;            ///< hit by both, but the method's hit is more than `step` behind
  std::uint64_t near = 0;            ///< hit by the method before the exact hit
  double max_delay = 0;              ///< greatest distance behind the exact hit, metres
  double depth_mean = 0, depth_p99 = 0, depth_max = 0;  ///< |difference of t|, in details (voxels)
  std::uint64_t normals = 0;                            ///< pairs of hits that have an axial face each
  double normal_angle = 0;                              ///< mean angle between the normals of those, degrees
  std::uint64_t cells = 0, wrong_cells = 0;             ///< pairs with labels known, and those that differ
  std::uint64_t voxels = 0, wrong_voxels = 0;           ///< pairs with elements known, and those that differ

  /// Shares of what can go wrong; 0 where nothing can.
  [[nodiscard]] double miss_rate() const { return share(missed, hits); }
  [[nodiscard]] double false_hit_rate() const { return share(false_hits, rays - hits); }
  [[nodiscard]] double wrong_cell_rate() const { return share(wrong_cells, cells); }
  [[nodiscard]] double wrong_voxel_rate() const { return share(wrong_voxels, voxels); }

 private:
  static double share(std::uint64_t part, std::uint64_t all) { return all ? double(part) / double(all) : 0; }
};

/// Compares hits of the same rays, whose directions have length 1: found[k] with truth[k] (spans of one
/// length, assert). `detail`: the edge of a voxel, metres. `step`: the distance, metres, from which a hit
/// counts as late.
[[nodiscard]] TracingError compare_hits(std::span<const StreamHit> truth, std::span<const StreamHit> found,
                                        double detail, double step = std::numeric_limits<double>::infinity());

/// Compares a method with exact tracing, ray by ray; `rays` and `step` as above.
[[nodiscard]] TracingError measure_tracing_error(const Caster& exact, const Caster& method,
                                                 std::span<const Ray> rays, double step,
                                                 unsigned threads = 0);

}  // namespace mesocell
