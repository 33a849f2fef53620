#pragma once

#include <cstdint>
#include <span>

#include "format/api.h"
#include "sdk/core/ray.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

/// How one method's first hits differ from exact tracing of the same asset. Shares are of the rays that exact
/// tracing hits.
struct TracingError {
  std::uint64_t rays = 0, hits = 0;  ///< rays compared, and how many exact tracing hits
  std::uint64_t missed = 0;          ///< hit exactly, missed by the method
  std::uint64_t late = 0;            ///< hit by both, but the method's hit is more than `step` behind
  std::uint64_t near = 0;            ///< hit by the method before the exact hit
  std::uint64_t false_hits = 0;      ///< hit by the method alone
  double max_delay = 0;              ///< greatest distance behind the exact hit, metres
};

/// Compares a method with exact tracing, ray by ray. `step`: the distance, metres, from which a hit counts as
/// late; the rays' directions have length 1.
[[nodiscard]] TracingError measure_tracing_error(const Caster& exact, const Caster& method,
                                                 std::span<const Ray> rays, double step,
                                                 unsigned threads = 0);

}  // namespace mesocell
