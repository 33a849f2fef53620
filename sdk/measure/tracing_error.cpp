#include "sdk/measure/tracing_error.h"

#include <algorithm>
#include <vector>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

void compare(const Caster& exact, const Caster& method, const Ray& ray, double step, TracingError& error) {
  Hit truth, found;
  const bool hit = exact.first_hit(ray, truth), method_hit = method.first_hit(ray, found);
  ++error.rays;
  error.hits += hit;
  error.false_hits += !hit && method_hit;
  error.missed += hit && !method_hit;
  if (!hit || !method_hit) return;
  error.near += found.t < truth.t;
  error.late += found.t > truth.t + step;
  error.max_delay = std::max(error.max_delay, found.t - truth.t);
}

}  // namespace

TracingError measure_tracing_error(const Caster& exact, const Caster& method, std::span<const Ray> rays,
                                   double step, unsigned threads) {
  constexpr std::size_t kChunk = 4096;
  std::vector<TracingError> parts((rays.size() + kChunk - 1) / kChunk);
  parallel_for(parts.size(), threads, [&](std::size_t k, unsigned) {
    for (const Ray& ray : rays.subspan(k * kChunk, std::min(kChunk, rays.size() - k * kChunk)))
      compare(exact, method, ray, step, parts[k]);
  });
  TracingError sum;
  for (const TracingError& p : parts) {
    sum.rays += p.rays;
    sum.hits += p.hits;
    sum.missed += p.missed;
    sum.late += p.late;
    sum.near += p.near;
    sum.false_hits += p.false_hits;
    sum.max_delay = std::max(sum.max_delay, p.max_delay);
  }
  return sum;
}

}  // namespace mesocell
