#include "sdk/measure/tracing_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

/// Degrees between the normals of two axial faces.
double angle_between(std::int8_t a, std::int8_t b) { return a == b ? 0 : a / 2 == b / 2 ? 180 : 90; }

void compare_pair(const StreamHit& truth, const StreamHit& found, double step, TracingError& error) {
  error.near += found.t < truth.t;
  error.late += found.t > truth.t + step;
  error.max_delay = std::max(error.max_delay, found.t - truth.t);
  if (truth.face >= 0 && found.face >= 0) {
    ++error.normals;
    error.normal_angle += angle_between(truth.face, found.face);
  }
  if (found.label != TracingError::kUnknownLabel) {
    ++error.cells;
    error.wrong_cells += found.label != truth.label;
  }
  if (found.element[0] != TracingError::kUnknownElement) {
    ++error.voxels;
    error.wrong_voxels += found.element != truth.element;
  }
}

}  // namespace

TracingError compare_hits(std::span<const StreamHit> truth, std::span<const StreamHit> found, double detail,
                          double step) {
  assert(truth.size() == found.size());
  TracingError error;
  std::vector<double> depths;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const bool hit = truth[k].hit(), method_hit = found[k].hit();
    ++error.rays;
    error.hits += hit;
    error.false_hits += !hit && method_hit;
    error.missed += hit && !method_hit;
    if (!hit || !method_hit) continue;
    compare_pair(truth[k], found[k], step, error);
    depths.push_back(std::abs(found[k].t - truth[k].t) / detail);
  }
  if (error.normals > 0) error.normal_angle /= double(error.normals);
  if (depths.empty()) return error;
  for (const double d : depths) {
    error.depth_mean += d;
    error.depth_max = std::max(error.depth_max, d);
  }
  error.depth_mean /= double(depths.size());
  const auto p99 = depths.begin() + std::ptrdiff_t((depths.size() - 1) * 99 / 100);
  std::nth_element(depths.begin(), p99, depths.end());
  error.depth_p99 = *p99;
  return error;
}

TracingError measure_tracing_error(const Caster& exact, const Caster& method, std::span<const Ray> rays,
                                   double step, unsigned threads) {
  constexpr std::size_t kChunk = 4096;
  std::vector<StreamHit> truth(rays.size()), found(rays.size());
  parallel_for((rays.size() + kChunk - 1) / kChunk, threads, [&](std::size_t k, unsigned) {
    const std::size_t first = k * kChunk, count = std::min(kChunk, rays.size() - first);
    exact.first_hits(rays.subspan(first, count), std::span(truth).subspan(first, count));
    method.first_hits(rays.subspan(first, count), std::span(found).subspan(first, count));
  });
  return compare_hits(truth, found, exact.detail(), step);
}

}  // namespace mesocell
