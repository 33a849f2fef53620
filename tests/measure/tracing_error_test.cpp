#include "sdk/measure/tracing_error.h"

#include <vector>

#include "tests/support/catch.h"

using namespace mesocell;

namespace {

StreamHit hit_at(double t, std::int32_t x = 1, std::uint32_t label = 1, std::int8_t face = 0) {
  return {.t = t, .element = {x, 2, 3}, .label = label, .face = face};
}

}  // namespace

TEST_CASE("every kind of error is counted over the rays that can have it") {
  const StreamHit miss;
  const std::vector<StreamHit> truth = {hit_at(1), hit_at(2), hit_at(3), miss, miss, hit_at(4), hit_at(5)};
  const std::vector<StreamHit> found = {hit_at(1),          hit_at(2.5, 7),    miss, hit_at(9), miss,
                                        hit_at(3, 1, 2, 1), hit_at(5, 1, 1, 2)};
  const TracingError e = compare_hits(truth, found, 0.25, 0.25);
  CHECK(e.rays == 7);
  CHECK(e.hits == 5);
  CHECK(e.missed == 1);
  CHECK(e.miss_rate() == Approx(1 / 5.0));
  CHECK(e.false_hits == 1);
  CHECK(e.false_hit_rate() == Approx(1 / 2.0));
  CHECK(e.late == 1);
  CHECK(e.near == 1);
  CHECK(e.max_delay == 0.5);
  // 0, 2, 4 and 0 voxels.
  CHECK(e.depth_mean == Approx(1.5));
  CHECK(e.depth_max == 4);
  CHECK(e.normals == 4);
  CHECK(e.normal_angle == Approx((0 + 0 + 180 + 90) / 4.0));
  CHECK(e.wrong_cell_rate() == Approx(1 / 4.0));
  CHECK(e.wrong_voxel_rate() == Approx(1 / 4.0));
}

TEST_CASE("what a method does not know is not held against it") {
  const std::vector<StreamHit> truth = {hit_at(1), hit_at(1, 1, 1, StreamHit::kBegan), hit_at(1)};
  std::vector<StreamHit> found = {hit_at(1, -1, TracingError::kUnknownLabel, StreamHit::kOther), hit_at(1),
                                  hit_at(1, 5, 5, 3)};
  found[0].element = {-1, -1, -1};
  const TracingError e = compare_hits(truth, found, 1);
  CHECK(e.normals == 1);
  CHECK(e.cells == 2);
  CHECK(e.wrong_cells == 1);
  CHECK(e.voxels == 2);
  CHECK(e.wrong_voxels == 1);
}

TEST_CASE("the 99th percentile leaves out the worst hundredth") {
  std::vector<StreamHit> truth, found;
  for (int k = 0; k < 1000; ++k) {
    truth.push_back(hit_at(10));
    found.push_back(hit_at(k < 985 ? 10 : k < 992 ? 12 : 50));
  }
  const TracingError e = compare_hits(truth, found, 1);
  CHECK(e.depth_p99 == 2);
  CHECK(e.depth_max == 40);
  CHECK(compare_hits({}, {}, 1).miss_rate() == 0);
}
