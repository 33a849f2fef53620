#include "converters/bench/bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "converters/bench/oracle.h"
#include "sdk/core/parallel.h"
#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

using Clock = std::chrono::steady_clock;

const Error kStopped{ErrorCode::kCancelled, "cancelled"};

/// A scene with its tracers.
struct Prepared {
  SceneName name;
  CellObject object;
  std::unique_ptr<Caster> exact;
  std::vector<NamedTracer> tracers;
};

/// Mean angle between rays and the surfaces that they hit, of a sample; degrees. A view that grazes a plane
/// says so itself: cells are rough, and of their own faces those are seen that are turned to the eye.
double mean_angle(const Caster& exact, std::span<const Ray> rays, const std::optional<Vec3>& plane) {
  double sum = 0;
  std::size_t count = 0;
  for (const std::size_t k : spread_sample(rays.size(), 8192)) {
    Hit hit;
    if (!exact.first_hit(rays[k], hit) || hit.face_normal == Vec3{}) continue;
    const Vec3 normal = plane ? *plane : exact.shading_normal(hit);
    const double sine = std::abs(dot(normal, rays[k].direction));
    sum += std::asin(std::min(1.0, sine)) * 180 / std::numbers::pi;
    ++count;
  }
  return count ? sum / double(count) : 0;
}

class Bench {
 public:
  Bench(const std::optional<BenchObject>& given, const BenchOptions& options, const Progress& progress)
      : given_(given), options_(options), quiet_{{}, progress.cancel} {
    // The machine's threads, or the most that are asked for.
    for (const unsigned t : options.timing.threads) threads_ = std::max(threads_, resolve_threads(t));
  }

  Status measure(const BenchCase& c) {
    if (!scene_ || scene_->name_of_case != c.scene)
      if (Status status = prepare(c.scene); !status) return status;
    Prepared& scene = scene_->prepared;
    const double tile_edge = scene.object.grid.voxel_edge * scene.object.tile.resolution[0];
    const Result<PlacedView> placed =
        make_view(c.view, *scene.exact, tile_edge, options_.size[0], options_.size[1]);
    if (!placed) {
      if (placed.error().code != ErrorCode::kInvalidInput) return placed.error();
      note(scene_->label + ", camera " + c.view.name + ": " + placed.error().message);
      return {};
    }
    RayStream stream;
    stream.coherent = is_coherent(c.rays);
    stream.rays = make_rays(c.rays, *scene.exact, placed->camera, options_.size[0], options_.size[1],
                            options_.seed, threads_, quiet_);
    if (quiet_.cancelled()) return kStopped;
    if (stream.rays.empty()) {
      note(scene_->label + ", camera " + c.view.name + ": no " + std::string(ray_set_name(c.rays)) + " rays");
      return {};
    }
    if (!find_truth(*scene.exact, stream)) return kStopped;
    const TracingError against_oracle = check_exact(scene.object, stream);
    TimingOptions timing = options_.timing;
    timing.detail = scene.object.grid.voxel_edge;
    Result<std::vector<TracerFigures>> figures = time_tracers(scene.tracers, stream, timing, quiet_);
    if (!figures) return figures.error();
    const bool grazes = placed->plane && c.rays == RaySet::kPrimary;
    const double angle = mean_angle(*scene.exact, stream.rays, grazes ? placed->plane : std::nullopt);
    for (TracerFigures& f : *figures) {
      if (f.method == "exact") {
        const TracingError& e = f.error;
        result_.exact_differs += e.missed + e.false_hits + e.wrong_voxels + e.wrong_cells + (e.depth_max > 0);
        f.error = against_oracle;
      }
      result_.rows.push_back({scene_->label, scene.name.shape, scene.name.tile, scene.name.tiles,
                              scene.name.resolution, c.view.name, std::string(ray_set_name(c.rays)), angle,
                              timing.repeat, std::move(f)});
    }
    return {};
  }

  void note(const std::string& text) {
    if (std::ranges::find(result_.notes, text) == result_.notes.end()) result_.notes.push_back(text);
  }

  [[nodiscard]] BenchResult take() { return std::move(result_); }

 private:
  struct Scene {
    std::string name_of_case, label;
    Prepared prepared;
  };

  Status prepare(const std::string& name) {
    scene_.reset();  // before another takes memory
    Scene scene{name, name, {}};
    Prepared& p = scene.prepared;
    if (name.empty()) {
      scene.label = given_->name;
      p.object = given_->object;
      p.name = {"file", "", *std::ranges::max_element(p.object.grid.tiles), p.object.tile.resolution[0]};
    } else {
      Result<SceneName> parsed = parse_scene_name(name);
      if (!parsed) return parsed.error();
      p.name = std::move(*parsed);
      Result<CellObject> object = make_scene(p.name, threads_, quiet_);
      if (!object) return object.error();
      p.object = std::move(*object);
    }
    Result<std::unique_ptr<Caster>> exact = make_cell_object_caster(p.object, "exact");
    if (!exact) return exact.error();
    p.exact = std::move(*exact);
    for (const std::string& method : options_.methods) {
      if (quiet_.cancelled()) return kStopped;
      Result<NamedTracer> tracer = make_tracer(p.object, method, threads_, options_.max_peer_bytes);
      if (tracer)
        p.tracers.push_back(std::move(*tracer));
      else if (tracer.error().code == ErrorCode::kLimit || options_.skip_missing)
        note((tracer.error().code == ErrorCode::kLimit ? scene.label + ", " : "") + method + ": " +
             tracer.error().message);
      else
        return tracer.error();
    }
    scene_ = std::move(scene);
    return {};
  }

  /// What exact tracing finds. False if cancelled.
  bool find_truth(const Caster& exact, RayStream& stream) const {
    stream.truth.resize(stream.rays.size());
    const std::span<const Ray> rays(stream.rays);
    const std::span<StreamHit> hits(stream.truth);
    return parallel_for((rays.size() + kBenchChunk - 1) / kBenchChunk, threads_,
                        [&](std::size_t k, unsigned) {
                          const std::size_t first = k * kBenchChunk,
                                            count = std::min(kBenchChunk, rays.size() - first);
                          exact.first_hits(rays.subspan(first, count), hits.subspan(first, count));
                        },
                        &quiet_);
  }

  /// Compares a sample of the truth with the oracle.
  TracingError check_exact(const CellObject& object, const RayStream& stream) {
    const std::vector<std::size_t> sample = spread_sample(stream.rays.size(), options_.oracle_rays);
    std::vector<StreamHit> oracle(sample.size()), found(sample.size());
    const bool done = parallel_for(
        sample.size(), threads_,
        [&](std::size_t k, unsigned) {
          oracle[k] = walk_to_hit(object, stream.rays[sample[k]]);
          found[k] = stream.truth[sample[k]];
        },
        &quiet_);
    if (!done) return {};  // whoever is next finds that it was cancelled
    for (std::size_t k = 0; k < sample.size(); ++k)
      result_.exact_differs += !same_hit(oracle[k], found[k], object.grid.voxel_edge);
    return compare_hits(oracle, found, object.grid.voxel_edge);
  }

  const std::optional<BenchObject>& given_;
  const BenchOptions& options_;
  Progress quiet_;  ///< the progress of all is told by cases
  unsigned threads_ = 1;
  std::optional<Scene> scene_;
  BenchResult result_;
};

}  // namespace

Result<BenchResult> run_bench(std::span<const BenchCase> cases, const std::optional<BenchObject>& object,
                              const BenchOptions& options, const Progress& progress) {
  if (!options.skip_missing)
    for (const std::string& method : options.methods)
      if (const Status status = try_method(method); !status) return status.error();
  const Clock::time_point start = Clock::now();
  Bench bench(object, options, progress);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (progress.cancelled()) return kStopped;
    const std::chrono::duration<double> spent = Clock::now() - start;
    if (options.max_seconds > 0 && spent.count() > options.max_seconds) {
      bench.note("the time was up before the last " + std::to_string(cases.size() - k) + " of " +
                 std::to_string(cases.size()) + " cases");
      break;
    }
    if (const Status status = bench.measure(cases[k]); !status) return status.error();
    if (progress.report) progress.report("measuring", double(k + 1) / double(cases.size()));
  }
  return bench.take();
}

}  // namespace mesocell
