#include "converters/bench/measure.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"

namespace mesocell {
namespace {

using Clock = std::chrono::steady_clock;

/// Rays of a stream that go to one call, and where their hits go.
struct Chunk {
  std::size_t first = 0, count = 0, to = 0;
};

/// `count` chunks of a stream, evenly spread; all of them if there are no more.
std::vector<Chunk> spread_chunks(std::size_t rays, std::size_t count) {
  const std::size_t all = (rays + kBenchChunk - 1) / kBenchChunk;
  std::vector<Chunk> chunks;
  std::size_t to = 0;
  for (const std::size_t k : spread_sample(all, count)) {
    const std::size_t first = k * kBenchChunk;
    const std::size_t size = std::min(kBenchChunk, rays - first);
    chunks.push_back({first, size, to});
    to += size;
  }
  return chunks;
}

/// Seconds of one pass; less than 0 if it was cancelled.
double time_pass(const Tracer& tracer, const RayStream& stream, std::span<const Chunk> chunks,
                 std::span<StreamHit> hits, unsigned threads, const Progress& progress) {
  const std::span<const Ray> rays(stream.rays);
  const Clock::time_point start = Clock::now();
  const bool done = parallel_for(
      chunks.size(), threads,
      [&](std::size_t k, unsigned) {
        const Chunk& c = chunks[k];
        tracer.trace(rays.subspan(c.first, c.count), hits.subspan(c.to, c.count), stream.coherent);
      },
      &progress);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return done ? seconds : -1;
}

/// How wrong a pass was, to tell the worst of several by.
std::pair<std::uint64_t, double> badness(const TracingError& e) {
  return {e.missed + e.false_hits + e.wrong_voxels + e.wrong_cells, e.depth_max};
}

/// A tracer in the making of its figures.
struct Runner {
  const NamedTracer* named = nullptr;
  std::vector<Chunk> chunks;
  std::span<const StreamHit> truth;      ///< of these chunks
  std::vector<StreamHit> part_of_truth;  ///< unless they are the whole stream
  std::optional<double> steps;           ///< a ray
  std::vector<double> seconds;
  TracingError error;

  [[nodiscard]] std::size_t ray_count() const { return truth.size(); }
};

void choose_chunks(Runner& runner, const RayStream& stream, std::size_t count) {
  runner.chunks = spread_chunks(stream.rays.size(), count);
  runner.part_of_truth.clear();
  runner.truth = stream.truth;
  if (runner.chunks.size() * kBenchChunk >= stream.rays.size()) return;
  for (const Chunk& c : runner.chunks) {
    const auto from = stream.truth.begin() + std::ptrdiff_t(c.first);
    runner.part_of_truth.insert(runner.part_of_truth.end(), from, from + std::ptrdiff_t(c.count));
  }
  runner.truth = runner.part_of_truth;
}

/// Finds how many rays there is time for, traces them once and counts steps. False if cancelled.
bool warm_up(Runner& runner, const RayStream& stream, const TimingOptions& options, std::span<StreamHit> hits,
             unsigned threads, const Progress& progress) {
  const std::size_t all = (stream.rays.size() + kBenchChunk - 1) / kBenchChunk;
  // At least a few for every thread, or one would wait for another.
  const std::size_t least = std::min<std::size_t>(all, 4 * threads);
  const Tracer& tracer = *runner.named->tracer;
  choose_chunks(runner, stream, least);
  const double pilot = time_pass(tracer, stream, runner.chunks, hits, threads, progress);
  if (pilot < 0) return false;
  const double affordable = options.pass_seconds / std::max(pilot, 1e-9) * double(least);
  if (affordable > double(least)) {
    choose_chunks(runner, stream, affordable >= double(all) ? all : std::size_t(affordable));
    if (time_pass(tracer, stream, runner.chunks, hits, threads, progress) < 0) return false;
  }
  std::atomic<std::uint64_t> steps{0};
  const std::span<const Ray> rays(stream.rays);
  const bool done = parallel_for(
      runner.chunks.size(), threads,
      [&](std::size_t k, unsigned) {
        steps += tracer.count_steps(rays.subspan(runner.chunks[k].first, runner.chunks[k].count));
      },
      &progress);
  if (steps > 0) runner.steps = double(steps) / double(std::max<std::size_t>(runner.ray_count(), 1));
  return done;
}

TracerFigures figures_of(const Runner& runner, unsigned threads) {
  TracerFigures out;
  out.method = runner.named->method;
  out.threads = threads;
  out.ray_count = runner.ray_count();
  for (const StreamHit& hit : runner.truth) out.hit_rate += hit.hit();
  out.hit_rate /= double(out.ray_count);
  std::vector<double> rates;
  for (const double s : runner.seconds) rates.push_back(double(out.ray_count) / std::max(s, 1e-9));
  std::ranges::sort(rates);
  out.rays_per_second = (rates[(rates.size() - 1) / 2] + rates[rates.size() / 2]) / 2;
  out.rays_per_second_min = rates.front();
  out.rays_per_second_max = rates.back();
  out.steps_per_ray = runner.steps;
  out.build_seconds = runner.named->build_seconds;
  out.peak_bytes = runner.named->tracer->memory_bytes();
  out.error = runner.error;
  return out;
}

}  // namespace

std::vector<std::size_t> spread_sample(std::size_t all, std::size_t count) {
  count = std::min(count, all);
  std::vector<std::size_t> sample;
  Rng rng(1);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t low = k * all / count, high = (k + 1) * all / count;
    sample.push_back(low + std::size_t(double(high - low) * rng.uniform()));
  }
  return sample;
}

Result<std::vector<TracerFigures>> time_tracers(std::span<const NamedTracer> tracers, const RayStream& stream,
                                                const TimingOptions& options, const Progress& progress) {
  const Error cancelled{ErrorCode::kCancelled, "cancelled"};
  std::vector<TracerFigures> figures;
  if (stream.rays.empty()) return figures;
  std::vector<StreamHit> hits(stream.rays.size());
  unsigned most = 1;
  for (const unsigned threads : options.threads) most = std::max(most, resolve_threads(threads));
  std::vector<Runner> runners(tracers.size());
  for (std::size_t m = 0; m < tracers.size(); ++m) {
    runners[m].named = &tracers[m];
    if (!warm_up(runners[m], stream, options, hits, most, progress)) return cancelled;
  }
  for (const unsigned wanted : options.threads) {
    const unsigned threads = resolve_threads(wanted);
    for (Runner& runner : runners) {
      runner.seconds.clear();
      runner.error = {};
    }
    for (std::uint32_t pass = 0; pass < options.repeat; ++pass)
      for (Runner& runner : runners) {
        // What the pass before left there must not pass for hits of this one.
        std::ranges::fill(hits, StreamHit{.t = -1});
        const double s = time_pass(*runner.named->tracer, stream, runner.chunks, hits, threads, progress);
        if (s < 0) return cancelled;
        runner.seconds.push_back(s);
        const TracingError error =
            compare_hits(runner.truth, std::span(hits).first(runner.ray_count()), options.detail);
        if (pass == 0 || badness(error) > badness(runner.error)) runner.error = error;
      }
    for (const Runner& runner : runners) figures.push_back(figures_of(runner, threads));
  }
  return figures;
}

}  // namespace mesocell
