#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "converters/bench/caster_tracer.h"
#include "sdk/core/progress.h"
#include "sdk/measure/tracing_error.h"

namespace mesocell {

/// Rays of one set, and what exact tracing finds.
struct RayStream {
  std::vector<Ray> rays;
  std::vector<StreamHit> truth;  ///< one a ray
  bool coherent = false;         ///< see Tracer::trace()
};

/// How tracers are timed.
struct TimingOptions {
  std::vector<unsigned> threads = {0};  ///< each of them; 0: the machine's
  std::uint32_t repeat = 3;             ///< timed passes, at least 1
  /// A method that would take longer than this for all rays, seconds a pass, traces a part of them: as many
  /// chunks, evenly spread, as it has time for.
  double pass_seconds = 0.15;
  double detail = 1;  ///< edge of a voxel, metres
};

/// What a method does with a stream.
struct TracerFigures {
  std::string method;
  unsigned threads = 0;
  std::uint64_t ray_count = 0;  ///< traced and compared, in every pass
  double hit_rate = 0;          ///< of those, by exact tracing
  double rays_per_second = 0, rays_per_second_min = 0, rays_per_second_max = 0;  ///< median, least, greatest
  std::optional<double> steps_per_ray;                                           ///< if it is counted
  double build_seconds = 0;
  std::uint64_t peak_bytes = 0;  ///< scene and acceleration data
  TracingError error;            ///< against the truth, of the pass that was off by the most
};

/// `count` different numbers below `all`, ascending: one of each of as many equal parts, at random, so that
/// no period of what is sampled shows; all of them if there are no more. The same every time.
[[nodiscard]] std::vector<std::size_t> spread_sample(std::size_t all, std::size_t count);

/// Rays that are traced by one call, 64 squares of 8 × 8 pixels.
inline constexpr std::size_t kBenchChunk = 4096;

/// Times tracers on the same rays: each is warmed up once, then all take turns, so that noise hits them
/// alike. Only the tracing is timed, and every hit of every pass is compared with the truth. Figures are
/// ordered by threads, then as the tracers. Errors: kCancelled.
[[nodiscard]] Result<std::vector<TracerFigures>> time_tracers(std::span<const NamedTracer> tracers,
                                                              const RayStream& stream,
                                                              const TimingOptions& options,
                                                              const Progress& progress);

}  // namespace mesocell
