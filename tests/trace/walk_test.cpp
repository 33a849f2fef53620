#include "sdk/trace/walk.h"

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/catch.h"

using namespace mesocell;

namespace {

/// The voxels that a ray visits in a grid of n³, one at a time.
std::vector<Voxel> walk(const Ray& ray, std::int64_t n) {
  WalkRay w;
  std::vector<Voxel> visited;
  WalkPlace place;
  if (!WalkRay::make(ray, w) || !enter_grid(w, {n, n, n}, place)) return visited;
  for (;;) {
    for (const std::int64_t c : place.voxel)
      if (c < 0 || c >= n) return visited;
    visited.push_back(place.voxel);
    const Voxel& v = place.voxel;
    leave_box(w, Voxel(v), {v[0] + 1, v[1] + 1, v[2] + 1}, place);
  }
}

}  // namespace

TEST_CASE("a ray along an axis visits one row") {
  const std::vector<Voxel> row = walk({{-1, 0.5, 0}, {2, 0, 0}}, 3);
  CHECK(row == std::vector<Voxel>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  CHECK(walk({{1, 1, 5}, {0, 0, -1}}, 3) == std::vector<Voxel>{{1, 1, 2}, {1, 1, 1}, {1, 1, 0}});
}

TEST_CASE("on the grid's border: the lower faces are in the grid, the upper ones are not") {
  CHECK(walk({{-1, 0, 0}, {1, 0, 0}}, 2).size() == 2);
  CHECK(walk({{-1, 2, 0}, {1, 0, 0}}, 2).empty());
  CHECK(walk({{2, 1, 1}, {1, 0, 0}}, 2).empty());
  CHECK(walk({{2, 1, 1}, {-1, 0, 0}}, 2) == std::vector<Voxel>{{1, 1, 1}, {0, 1, 1}});
  CHECK(walk({{0, 0, 0}, {-1, 0, 0}}, 2) == std::vector<Voxel>{{0, 0, 0}});
}

TEST_CASE("through corners: half-open voxels decide which are visited") {
  // Rising on all axes, the corner is the first point of the next voxel.
  CHECK(walk({{0, 0, 0}, {1, 1, 1}}, 2) == std::vector<Voxel>{{0, 0, 0}, {1, 1, 1}});
  // Falling on all axes, it is the last point of the one before.
  CHECK(walk({{2, 2, 2}, {-1, -1, -1}}, 2) == std::vector<Voxel>{{1, 1, 1}, {0, 0, 0}});
  // Rising on x and falling on y: the corner itself is in a third voxel.
  CHECK(walk({{0.5, 1.5, 0}, {1, -1, 0}}, 2) == std::vector<Voxel>{{0, 1, 0}, {1, 1, 0}, {1, 0, 0}});
}

TEST_CASE("every voxel that a ray visits follows the one before") {
  // Slopes that rounding cannot represent, met at lattice points.
  const std::vector<Voxel> v = walk({{0, 0, 0}, {3, 1.0 / 3, 0.1}}, 300);
  REQUIRE(v.size() > 300);
  for (std::size_t k = 1; k < v.size(); ++k) {
    std::int64_t steps = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      CHECK(v[k][a] - v[k - 1][a] >= 0);
      steps += v[k][a] - v[k - 1][a];
    }
    CHECK(steps >= 1);
    CHECK(steps <= 3);
  }
}

TEST_CASE("rays without direction, and numbers that are none, are refused") {
  WalkRay w;
  CHECK_FALSE(WalkRay::make({{0, 0, 0}, {0, 0, 0}}, w));
  CHECK_FALSE(WalkRay::make({{0, 0, std::nan("")}, {1, 0, 0}}, w));
  CHECK_FALSE(WalkRay::make({{0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}}, w));
  CHECK_FALSE(WalkRay::make({{0x1p47, 0, 0}, {1, 0, 0}}, w));
  CHECK(WalkRay::make({{0, 0, 0}, {5e-324, 0, 0}}, w));
  CHECK(w.direction[0] == 1);
  CHECK(WalkRay::make({{0, 0, 0}, {1e-300, 1e300, 0}}, w));
  CHECK(w.direction[0] == 0);
}
