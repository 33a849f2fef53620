#include "converters/bench/measure.h"

#include <atomic>
#include <memory>
#include <thread>

#include "converters/bench/bench.h"
#include "converters/bench/oracle.h"
#include "sdk/core/rng.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Rays from points around an object of `size` metres towards points in it.
std::vector<Ray> random_rays(double size, std::size_t count) {
  Rng rng(3);
  const auto point = [&](double low, double high) {
    return Vec3{rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high)};
  };
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Vec3 from = point(-size, 2 * size), to = point(0, size);
    rays.push_back({from, normalize(to - from)});
  }
  return rays;
}

CellObject some_object() {
  Rng rng(5);
  return random_object(rng, "worley:cells=6,resolution=8,seed=2", {4, 4, 4}, 0.3);
}

RayStream exact_stream(const CellObject& object, std::size_t count) {
  RayStream stream;
  stream.rays = random_rays(32, count);
  stream.truth.resize(count);
  (*make_cell_object_caster(object, "exact"))->first_hits(stream.rays, stream.truth);
  return stream;
}

enum class Fault { kNone, kMiss, kFalse, kDeep, kCell, kVoxel, kSilent };

/// Says what is known, but for one ray in the calls from `begin` to before `end`.
class PlantedTracer final : public Tracer {
 public:
  PlantedTracer(const RayStream& stream, Fault fault, int begin, int end)
      : stream_(stream), fault_(fault), begin_(begin), end_(end) {}

  void trace(std::span<const Ray> rays, std::span<StreamHit> hits, bool) const override {
    const int call = calls_++;
    bool plant = call >= begin_ && call < end_;
    if (plant && fault_ == Fault::kSilent) return;
    const std::size_t first = std::size_t(rays.data() - stream_.rays.data());
    for (std::size_t k = 0; k < rays.size(); ++k) {
      StreamHit& hit = hits[k] = stream_.truth[first + k];
      if (!plant || hit.hit() == (fault_ == Fault::kFalse)) continue;
      plant = false;
      if (fault_ == Fault::kMiss) hit = {};
      if (fault_ == Fault::kFalse) hit.t = 1;
      if (fault_ == Fault::kDeep) hit.t += 3;
      if (fault_ == Fault::kCell) ++hit.label;
      if (fault_ == Fault::kVoxel) ++hit.element[1];
    }
  }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return 1234; }
  [[nodiscard]] std::uint64_t count_steps(std::span<const Ray> rays) const override {
    return 5 * rays.size();
  }

 private:
  const RayStream& stream_;
  Fault fault_;
  int begin_, end_;
  mutable std::atomic<int> calls_{0};
};

/// Takes 20 ms a call.
class SlowTracer final : public Tracer {
 public:
  explicit SlowTracer(const RayStream& stream) : stream_(stream) {}
  void trace(std::span<const Ray> rays, std::span<StreamHit> hits, bool) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::size_t first = std::size_t(rays.data() - stream_.rays.data());
    for (std::size_t k = 0; k < rays.size(); ++k) hits[k] = stream_.truth[first + k];
  }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return 0; }

 private:
  const RayStream& stream_;
};

TracerFigures time_one(std::unique_ptr<Tracer> tracer, const RayStream& stream, TimingOptions options = {}) {
  std::vector<NamedTracer> tracers;
  tracers.push_back({"one", std::move(tracer), 0.5});
  options.threads = {2};
  Result<std::vector<TracerFigures>> figures = time_tracers(tracers, stream, options, {});
  REQUIRE(figures.ok());
  REQUIRE(figures->size() == 1);
  return std::move(figures->front());
}

}  // namespace

TEST_CASE("the oracle is what the definition says, evaluated without rounding") {
  const CellObject object = some_object();
  Rng rng(11);
  int hits = 0;
  for (int k = 0; k < 1500; ++k) {
    std::array<WideRational, 3> origin, direction, inverse;
    Vec3 from, along;
    for (std::size_t a = 0; a < 3; ++a) {
      // Halves of a voxel, so that many rays go through edges and corners.
      const int o = int(rng.below(160)) - 48, d = int(rng.below(9)) - 4;
      from[a] = o / 2.0;
      along[a] = d;
      origin[a] = {o, 2};
      direction[a] = {d, 1};
      inverse[a] = {1, d == 0 ? 1 : d};
    }
    if (along == Vec3{}) continue;
    const auto truth = first_hit_by_definition(object, origin, direction, inverse);
    const StreamHit hit = walk_to_hit(object, {from, along});
    REQUIRE(hit.hit() == truth.has_value());
    if (!truth) continue;
    ++hits;
    for (std::size_t a = 0; a < 3; ++a) CHECK(hit.element[a] == truth->voxel[a]);
    CHECK(hit.t == Approx(to_double(truth->t)).margin(1e-12));
    CHECK(int(hit.face) == truth->face);
    CHECK(hit.label > 0);
  }
  CHECK(hits > 60);
}

TEST_CASE("exact tracing says what the oracle says") {
  const CellObject object = some_object();
  const RayStream stream = exact_stream(object, 3000);
  for (std::size_t k = 0; k < stream.rays.size(); ++k) {
    const StreamHit truth = walk_to_hit(object, stream.rays[k]);
    REQUIRE(same_hit(truth, stream.truth[k], 1));
    if (!truth.hit()) continue;
    StreamHit other = truth;
    ++other.element[2];
    CHECK_FALSE(same_hit(truth, other, 1));
    CHECK_FALSE(same_hit(truth, {}, 1));
  }
}

TEST_CASE("one wrong hit in one pass is found") {
  const RayStream stream = exact_stream(some_object(), 2 * kBenchChunk);
  const auto error = [&](Fault fault, int begin, int end) {
    std::vector<NamedTracer> tracers;
    tracers.push_back({"one", std::make_unique<PlantedTracer>(stream, fault, begin, end), 0});
    const auto figures =
        time_tracers(tracers, stream, {.threads = {1}, .repeat = 3, .pass_seconds = 9, .detail = 0.5}, {});
    REQUIRE(figures.ok());
    return figures->front().error;
  };
  // Two calls are a pass; two passes warm up.
  for (int pass = 0; pass < 3; ++pass) {
    INFO("pass " << pass);
    const int begin = 4 + 2 * pass, end = begin + 1;
    const TracingError none = error(Fault::kNone, begin, end);
    CHECK(none.rays == 2 * kBenchChunk);
    CHECK(none.missed + none.false_hits + none.wrong_cells + none.wrong_voxels == 0);
    CHECK(none.depth_max == 0);
    CHECK(error(Fault::kMiss, begin, end).missed == 1);
    CHECK(error(Fault::kFalse, begin, end).false_hits == 1);
    CHECK(error(Fault::kDeep, begin, end).depth_max == Approx(6));
    CHECK(error(Fault::kCell, begin, end).wrong_cells == 1);
    CHECK(error(Fault::kVoxel, begin, end).wrong_voxels == 1);
    // Hits that are not written are not those of the pass before.
    CHECK(error(Fault::kSilent, begin, end).false_hits > 100);
  }
  CHECK(error(Fault::kMiss, 0, 4).missed == 0);
}

TEST_CASE("figures are what the tracer and the stream say") {
  const RayStream stream = exact_stream(some_object(), 9000);
  const TracerFigures f =
      time_one(std::make_unique<PlantedTracer>(stream, Fault::kNone, 0, 0), stream, {.pass_seconds = 9});
  CHECK(f.method == "one");
  CHECK(f.threads == 2);
  CHECK(f.ray_count == 9000);
  CHECK(f.peak_bytes == 1234);
  CHECK(f.build_seconds == 0.5);
  CHECK(f.steps_per_ray == 5.0);
  CHECK(f.rays_per_second_min <= f.rays_per_second);
  CHECK(f.rays_per_second <= f.rays_per_second_max);
  CHECK(f.hit_rate == Approx(double(f.error.hits) / 9000));
}

TEST_CASE("samples are spread evenly, but in no step with what they are of") {
  const std::vector<std::size_t> sample = spread_sample(200, 10);
  REQUIRE(sample.size() == 10);
  std::size_t odd = 0;
  for (std::size_t k = 0; k < 10; ++k) {
    CHECK(sample[k] >= 20 * k);
    CHECK(sample[k] < 20 * (k + 1));
    odd += sample[k] % 2;
  }
  CHECK(odd > 1);
  CHECK(odd < 9);
  CHECK(spread_sample(3, 9) == std::vector<std::size_t>{0, 1, 2});
  CHECK(spread_sample(0, 9).empty());
}

TEST_CASE("a method that is too slow traces a part of the rays") {
  RayStream stream;
  stream.rays = random_rays(32, 20 * kBenchChunk + 5);
  stream.truth.resize(stream.rays.size());
  for (std::size_t k = 0; k < stream.truth.size(); k += 2) stream.truth[k].t = double(k);
  const TracerFigures f =
      time_one(std::make_unique<SlowTracer>(stream), stream, {.repeat = 1, .pass_seconds = 0.001});
  CHECK(f.ray_count >= 7 * kBenchChunk);
  CHECK(f.ray_count <= 8 * kBenchChunk);
  CHECK(f.error.rays == f.ray_count);
  CHECK(f.error.missed + f.error.false_hits == 0);
  CHECK(f.error.depth_max == 0);
  CHECK_FALSE(f.steps_per_ray.has_value());
}

TEST_CASE("a benchmark can be stopped") {
  const RayStream stream = exact_stream(some_object(), 100);
  std::vector<NamedTracer> tracers;
  tracers.push_back({"one", std::make_unique<SlowTracer>(stream), 0});
  const std::atomic<bool> stop{true};
  const auto figures = time_tracers(tracers, stream, {}, Progress{{}, &stop});
  REQUIRE_FALSE(figures.ok());
  CHECK(figures.error().code == ErrorCode::kCancelled);
}
