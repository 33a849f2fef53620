#include "converters/stability/cast_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "sdk/core/parallel.h"
#include "sdk/shade/radiance.h"
#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

constexpr std::array kMethods = {
    CastMethod{"exact", "the first voxel that the ray visits", true, false, false},
    CastMethod{"linear:1/512", "the source's search, 512 samples a tile edge", false, true, true},
    CastMethod{"linear:1/128", "the same with 128", false, true, true},
    CastMethod{"linear:1/128:angle", "the same with a step that is shorter for rays along the surface", false,
               true, false},
    CastMethod{"distance", "steps of the distance to other cells, in single precision", false, false, false},
    CastMethod{"lod:1px", "the coarsest level of the tile whose voxels are below a pixel", false, false,
               false},
};

/// What a caster says to a probe.
struct Answer {
  bool hit = false;
  std::uint32_t cell = 0;
  double error = 0;  ///< voxels from the truth, where both hit
};

Answer ask_first_hit(const CastCase& c, const CastProbe& p, const Caster& caster) {
  Hit hit;
  if (!caster.first_hit(p.ray, hit)) return {};
  return {true, hit.label, std::abs(hit.t - p.t) * length(p.ray.direction) / c.object.grid.voxel_edge};
}

/// The exit, and whether light leaves by it, as the renderer decides.
Answer ask_exit(const CastCase& c, const CastProbe& p, const Caster& caster) {
  Hit hit;
  if (!caster.first_exit(p.ray, hit)) return {};
  bool leaves = true;
  if (c.question == CastQuestion::kRefraction)
    leaves = refract(p.ray.direction, -caster.shading_normal(hit), kCastIor).has_value();
  return {leaves, hit.label, std::abs(hit.t - p.t) / c.object.grid.voxel_edge};
}

/// Follows a ray from mirror to mirror, as the renderer does.
Answer ask_reflections(const CastCase& c, const CastProbe& p, const Caster& caster) {
  Ray ray = p.ray;
  Hit hit;
  Vec3 point;
  for (std::uint32_t k = 0; k < c.mirrors; ++k) {
    if (!caster.first_hit(ray, hit)) return {};
    point = ray.origin + ray.direction * hit.t;
    const Vec3 normal = caster.shading_normal(hit);
    Vec3 start = point + hit.face_normal * kCastStart;
    for (double lift = 0.5; caster.inside(start) && lift <= 2.5; lift += 0.5) start = point + normal * lift;
    ray = {start, reflect(ray.direction, normal)};
  }
  return {true, hit.label, length(point - p.last)};
}

Answer ask(const CastCase& c, const CastProbe& p, const Caster& caster) {
  switch (c.question) {
    case CastQuestion::kFirstHit:
      return ask_first_hit(c, p, caster);
    case CastQuestion::kFirstExit:
    case CastQuestion::kRefraction:
      return ask_exit(c, p, caster);
    case CastQuestion::kReflections:
      return ask_reflections(c, p, caster);
  }
  return {};
}

/// Rounding of the ray's numbers and of t, voxels; generous.
double rounding(const CastCase& c, const CastProbe& p) {
  const double t = p.t * length(p.ray.direction) / c.object.grid.voxel_edge;
  return 1e-9 + 1e-13 * (t + length(p.ray.origin) / c.object.grid.voxel_edge);
}

CastVerdict judge(const CastErrors& errors, CastPrediction prediction, const CastMethod& method) {
  if (errors.wrong() == 0) return CastVerdict::kHolds;
  const bool predicted = (prediction == CastPrediction::kThin && method.fails_on_thin) ||
                         (prediction == CastPrediction::kGrazing && method.fails_at_grazing);
  // What is predicted is that cells are passed by, not that there are hits where nothing is.
  return predicted && errors.false_hits == 0 ? CastVerdict::kFailsAsPredicted : CastVerdict::kFails;
}

}  // namespace

std::span<const CastMethod> cast_methods() { return kMethods; }

const char* verdict_name(CastVerdict verdict) {
  switch (verdict) {
    case CastVerdict::kHolds:
      return "holds";
    case CastVerdict::kFails:
      return "fails";
    case CastVerdict::kFailsAsPredicted:
      return "fails as the source predicts";
  }
  return "";
}

CastErrors measure_case(const CastCase& c, const Caster& caster, bool exact, unsigned threads) {
  std::vector<Answer> answers(c.probes.size());
  constexpr std::size_t kChunk = 256;
  parallel_for((answers.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk, unsigned) {
    for (std::size_t k = chunk * kChunk; k < std::min(answers.size(), (chunk + 1) * kChunk); ++k)
      answers[k] = ask(c, c.probes[k], caster);
  });
  CastErrors e;
  std::vector<double> depths;
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const CastProbe& p = c.probes[k];
    const Answer& a = answers[k];
    ++e.rays;
    e.hits += p.hit;
    e.missed += p.hit && !a.hit;
    e.false_hits += !p.hit && a.hit;
    rays.push_back(p.ray);
    if (!p.hit || !a.hit) continue;
    depths.push_back(a.error);
    const double tolerance =
        exact ? c.slack + rounding(c, p) : kCastTolerance * std::max<std::uint32_t>(c.mirrors, 1);
    if (p.cell != 0 && a.cell != p.cell)
      ++e.wrong_cell;
    else
      e.off += !(a.error <= tolerance);
  }
  if (c.question == CastQuestion::kFirstHit) e.steps = caster.count_steps(rays);
  if (depths.empty()) return e;
  std::ranges::sort(depths);
  double sum = 0;
  for (const double d : depths) sum += d;
  e.depth_mean = sum / double(depths.size());
  e.depth_p99 = depths[(depths.size() - 1) * 99 / 100];
  e.depth_max = depths.back();
  return e;
}

Result<std::vector<CastResult>> measure_cast_stability(std::span<const CastCase> cases,
                                                       std::span<const CastMethod> methods, unsigned threads,
                                                       const Progress* progress) {
  std::vector<CastResult> results;
  const double all = double(cases.size() * methods.size());
  for (const CastCase& c : cases)
    for (const CastMethod& method : methods) {
      if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
      if (progress && progress->report) progress->report("tracing", double(results.size()) / all);
      Result<std::unique_ptr<Caster>> caster = make_cell_object_caster(c.object, method.name);
      if (!caster) return caster.error();
      CastResult r{c.group, c.name, c.strength, method.name, {}, CastVerdict::kHolds, method.exact};
      r.errors = measure_case(c, **caster, method.exact, threads);
      r.verdict = judge(r.errors, c.prediction, method);
      results.push_back(std::move(r));
    }
  return results;
}

}  // namespace mesocell
