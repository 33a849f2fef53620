#include <xmmintrin.h>

#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "converters/bench/tracer.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

constexpr std::uint64_t kRoom = std::uint64_t{1} << 30;

/// A tracer, or none where the peer is not built; any other failure is the test's.
std::unique_ptr<Tracer> make(const CellObject& object, const std::string& name) {
  Result<std::unique_ptr<Tracer>> made = make_peer_tracer(object, name, 2, kRoom);
  if (made) return std::move(*made);
  INFO(made.error().message);
  REQUIRE(made.error().message.find("built without") != std::string::npos);
  WARN(name << ": " << made.error().message);
  return nullptr;
}

/// Empty tiles and mixed ones, cells with gaps in between, its corner somewhere.
CellObject loose_object(std::uint32_t resolution) {
  Rng rng(7);
  CellObject object = random_object(
      rng, "ellipsoids:cells=6,resolution=" + std::to_string(resolution) + ",seed=3", {6, 5, 7}, 0.7);
  object.grid.voxel_edge = 0.125;
  object.grid.box_min = {-3.5, 1, 2};
  return object;
}

Vec3 centre_of(const CellObject& object) {
  const auto high = object.box_max();
  const auto& low = object.grid.box_min;
  return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
}

/// A picture's rays, squares of 8 × 8 pixels in turn.
std::vector<Ray> picture(const CellObject& object, int width, int height) {
  const Vec3 middle = centre_of(object);
  const Vec3 eye{middle.x - 17, middle.y + 9, middle.z - 23};
  std::vector<Ray> rays;
  for (int by = 0; by < height; by += 8)
    for (int bx = 0; bx < width; bx += 8)
      for (int k = 0; k < 64; ++k) {
        const double u = (bx + k % 8 + 0.5) / width - 0.5, v = (by + k / 8 + 0.5) / height - 0.5;
        const Vec3 to{middle.x + 12 * u, middle.y + 12 * v, middle.z - 5 * u};
        rays.push_back({eye, (1 / length(to - eye)) * (to - eye)});
      }
  return rays;
}

/// Rays from the box and around it, every way.
std::vector<Ray> scattered(const CellObject& object, std::size_t count) {
  Rng rng(11);
  const Vec3 middle = centre_of(object);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const auto vector = [&] { return Vec3{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5}; };
    const Vec3 from = vector(), way = vector();
    if (length(way) < 0.1) continue;
    rays.push_back(
        {{middle.x + 20 * from.x, middle.y + 20 * from.y, middle.z + 20 * from.z}, (1 / length(way)) * way});
  }
  return rays;
}

struct Agreement {
  std::size_t rays = 0, hits = 0, hit = 0, depth = 0, voxel = 0, label = 0, face = 0;
};

Agreement compare(const CellObject& object, const Tracer& tracer, const std::vector<Ray>& rays,
                  bool coherent) {
  const auto exact = std::move(*make_cell_object_caster(object, "exact"));
  std::vector<StreamHit> want(rays.size()), have(rays.size());
  exact->first_hits(rays, want);
  tracer.trace(rays, have, coherent);
  Agreement a;
  a.rays = rays.size();
  for (std::size_t k = 0; k < rays.size(); ++k) {
    a.hit += want[k].hit() == have[k].hit();
    if (!want[k].hit() || !have[k].hit()) continue;
    ++a.hits;
    a.depth += std::abs(want[k].t - have[k].t) <= 1e-3 * object.grid.voxel_edge;
    a.voxel += want[k].element == have[k].element;
    a.face += want[k].face == have[k].face;
    a.label += want[k].label == have[k].label || have[k].label == 0xffffffffu;
  }
  return a;
}

/// A thousandth of the rays go by edges so near that rounding decides what they meet.
void check(const Agreement& a) {
  INFO(a.rays << " rays, " << a.hits << " hits; equal: hit " << a.hit << ", depth " << a.depth << ", voxel "
              << a.voxel << ", face " << a.face << ", label " << a.label);
  CHECK(a.hits > a.rays / 10);
  CHECK(a.hits < a.rays);
  CHECK(1000 * (a.rays - a.hit) <= a.rays);
  for (const std::size_t equal : {a.depth, a.voxel, a.face, a.label})
    CHECK(1000 * (a.hits - equal) <= a.hits);
}

}  // namespace

TEST_CASE("peers find what exact tracing finds") {
  const std::string name =
      GENERATE("embree-instanced", "embree-instanced:1", "embree-instanced:8", "embree-instanced:16",
               "embree-instanced:stream", "embree-surface", "embree-surface:8", "openvdb", "nanovdb");
  const std::uint32_t resolution =
      GENERATE(16u, 13u);  // blocks of 8³ fit a tile of the one, not of the other
  CAPTURE(name, resolution);
  const CellObject object = loose_object(resolution);
  const auto tracer = make(object, name);
  if (!tracer) return;
  check(compare(object, *tracer, picture(object, 256, 192), true));
  check(compare(object, *tracer, scattered(object, 20000), false));
  CHECK(tracer->memory_bytes() > 1000);
  CHECK(tracer->memory_bytes() < kRoom);
}

TEST_CASE("peers find what exact tracing finds in a tile without gaps") {
  const std::string name = GENERATE("embree-instanced", "embree-surface", "openvdb", "nanovdb");
  CAPTURE(name);
  Rng rng(5);
  const CellObject object = random_object(rng, "voronoi:cells=8,resolution=24,seed=2", {5, 6, 4}, 0.5);
  const auto tracer = make(object, name);
  if (!tracer) return;
  std::vector<Ray> rays = scattered(object, 20000);
  // From without: what begins in a cell may leave it by a face that is also of the next one, and Embree tells
  // of either.
  for (Ray& ray : rays) ray.origin = ray.origin - 300 * ray.direction;
  check(compare(object, *tracer, rays, false));
}

TEST_CASE("rays along axes meet blocks where they are, for every peer") {
  const std::string name =
      GENERATE("embree-instanced:1", "embree-instanced:8", "embree-surface:1", "openvdb", "nanovdb");
  CAPTURE(name);
  const CellObject object = make_blocks(
      {8, 8, 8}, 8, [](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (x + y + z) % 3 == 0; });
  const auto tracer = make(object, name);
  if (!tracer) return;
  std::vector<Ray> rays;
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 64; ++k) {
      Vec3 origin{2.5 + k % 8 * 8, 4.5 + k / 8 * 8, 4.5 + k / 8 * 8}, direction{};
      std::swap(origin[0], origin[std::size_t(axis)]);
      const bool up = k % 2;
      origin[std::size_t(axis)] = up ? -10 : 80;
      direction[std::size_t(axis)] = up ? 1 : -1;
      rays.push_back({origin, direction});
    }
  const Agreement a = compare(object, *tracer, rays, false);
  CHECK(a.hits > 100);
  CHECK(a.hit == a.rays);
  CHECK(a.depth == a.hits);
  CHECK(a.voxel == a.hits);
  CHECK(a.face == a.hits);
}

TEST_CASE("a peer that takes too much says so before it does") {
  const CellObject object = loose_object(16);
  for (const std::string name : {"embree-instanced", "embree-surface", "openvdb", "nanovdb"}) {
    CAPTURE(name);
    if (!make(object, name)) continue;
    const auto made = make_peer_tracer(object, name, 1, 20000);
    REQUIRE(!made);
    INFO(made.error().message);
    CHECK(made.error().code == ErrorCode::kLimit);
    CHECK(made.error().message.find("; ") != std::string::npos);
  }
}

TEST_CASE("an object of which nothing is inside is missed by every peer") {
  const CellObject object = make_blocks({4, 4, 4}, 8, [](auto...) { return false; });
  const std::vector<Ray> rays = scattered(object, 1000);
  for (const std::string name : {"embree-instanced", "embree-surface", "openvdb", "nanovdb"}) {
    CAPTURE(name);
    const auto tracer = make(object, name);
    if (!tracer) continue;
    std::vector<StreamHit> hits(rays.size(), StreamHit{1, {}, 1, 0});
    tracer->trace(rays, hits, false);
    for (const StreamHit& hit : hits) CHECK(!hit.hit());
  }
}

TEST_CASE("rays that are none are missed by every peer") {
  const CellObject object = make_blocks({4, 4, 4}, 8, [](auto...) { return true; });
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  const std::vector<Ray> rays = {{{-5, 9, 9}, {0, 0, 0}},    {{-5, 9, 9}, {kNan, 0.6, 0.8}},
                                 {{kNan, 9, 9}, {0, 0, 1}},  {{-5, 9, kInf}, {1, 0, 0}},
                                 {{-5, 9, 9}, {1, kNan, 0}}, {{9, 9, 9}, {0, 0, 0}}};
  for (const std::string name : {"embree-instanced:1", "embree-instanced:8", "embree-instanced:16",
                                 "embree-instanced:stream", "openvdb", "nanovdb"}) {
    CAPTURE(name);
    const auto tracer = make(object, name);
    if (!tracer) continue;
    std::vector<StreamHit> hits(rays.size(), StreamHit{1, {}, 1, 0});
    tracer->trace(rays, hits, false);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      CAPTURE(k);
      CHECK(!hits[k].hit());
    }
  }
}

TEST_CASE("names that are no peer's are told, with those that are") {
  const CellObject object = make_blocks({4, 4, 4}, 8, [](auto...) { return true; });
  for (const std::string name :
       {"", "embree", "embree-instanced:", "embree-instanced:4", "openvdb:8", "exact"}) {
    CAPTURE(name);
    const auto made = make_peer_tracer(object, name, 1, kRoom);
    REQUIRE(!made);
    if (made.error().message.find("built without") != std::string::npos) continue;
    CHECK(made.error().code == ErrorCode::kUsage);
  }
}

TEST_CASE("tracing by Embree leaves denormal numbers as they were, on several threads") {
  const CellObject object = loose_object(16);
  const auto tracer = make(object, "embree-instanced");
  if (!tracer) return;
  const std::vector<Ray> rays = scattered(object, 4000);
  std::vector<StreamHit> one(rays.size()), other(rays.size());
  const unsigned before = _mm_getcsr() & 0x8040u;
  unsigned after = 0;
  std::thread thread([&] {
    tracer->trace(rays, other, false);
    after = _mm_getcsr() & 0x8040u;
  });
  tracer->trace(rays, one, false);
  thread.join();
  CHECK((_mm_getcsr() & 0x8040u) == before);
  CHECK(after == before);
  for (std::size_t k = 0; k < rays.size(); ++k) CHECK(one[k].t == other[k].t);
}
