#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/membership/membership.h"
#include "sdk/membership/winding_number.h"
#include "tests/support/catch.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// A coordinate of the kind that methods stumble over: on voxel faces, on voxel centres, a rounding error
/// beside them, far away, anywhere.
double coordinate(Rng& rng, std::uint32_t size) {
  const double whole = double(rng.below(size + 3)) - 1;
  const auto nudged = [&](double x) {
    return std::nextafter(
        x, rng.below(2) ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity());
  };
  switch (rng.below(8)) {
    case 0:
    case 1:
      return whole;
    case 2:
    case 3:
      return whole + 0.5;
    case 4:
      return nudged(whole + 0.5);
    case 5:
      return nudged(whole);
    case 6:
      return rng.below(4) == 0 ? rng.uniform(-1e6, 1e6) : rng.uniform(-20, size + 20);
    default:
      return rng.uniform(0, size);
  }
}

Vec3 vertex(Rng& rng, const Index3& size) {
  return {coordinate(rng, size[0]), coordinate(rng, size[1]), coordinate(rng, size[2])};
}

/// A closed mesh: boundaries of boxes and tetrahedra, of which many are slivers, overlap, share faces, edges
/// or vertices, are flat, or inside out.
TriangleMesh hostile_mesh(Rng& rng, const Index3& size) {
  TriangleMesh mesh;
  std::vector<Vec3> used;
  for (std::uint64_t part = 0, parts = 1 + rng.below(4); part < parts; ++part) {
    TriangleMesh solid;
    if (rng.below(3) == 0) {
      const Vec3 a = vertex(rng, size), b = vertex(rng, size);
      solid = make_box({std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
                       {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)});
    } else {
      Vec3 v[4];
      for (Vec3& p : v)
        p = !used.empty() && rng.below(4) == 0 ? used[rng.below(std::uint32_t(used.size()))]
                                               : vertex(rng, size);
      // Slivers: the last vertex nearly on an edge, or nearly on the plane of the others.
      const double s = rng.uniform(), t = rng.uniform() * (1 - s);
      if (rng.below(3) == 0) v[3] = v[0] + (v[1] - v[0]) * s + (v[2] - v[0]) * (rng.below(2) ? t : 1e-12);
      solid = make_tetrahedron(v[0], v[1], v[2], v[3]);
    }
    used.insert(used.end(), solid.vertices.begin(), solid.vertices.end());
    if (rng.below(3) == 0) flip(solid);
    append(mesh, solid);
  }
  return mesh;
}

struct Grid {
  Index3 resolution, tiles;
  std::size_t cases;
};

}  // namespace

TEST_CASE("every voxel of ten thousand hostile meshes is on its side") {
  Rng rng(20'000'117);
  std::uint64_t cases = 0, wrong = 0, wrong_points = 0, inside_voxels = 0, mixed = 0;
  for (const Grid& grid :
       {Grid{{4, 4, 4}, {2, 2, 2}, 5000}, Grid{{8, 8, 8}, {1, 1, 1}, 2500}, Grid{{3, 5, 4}, {3, 1, 2}, 2500},
        Grid{{5, 5, 5}, {10, 10, 10}, 50}, Grid{{8, 8, 8}, {8, 8, 8}, 30},
        Grid{{10, 10, 10}, {10, 10, 10}, 10}, Grid{{10, 4, 25}, {5, 16, 4}, 10}}) {
    const TileMap tile = single_voxel_cells(grid.resolution);
    const Index3 size = voxels_of(grid.tiles, tile);
    for (std::size_t k = 0; k < repetitions(grid.cases); ++k, ++cases) {
      const TriangleMesh mesh = hostile_mesh(rng, size);
      const std::vector<bool> expected = inside_by_definition(mesh, size);
      const Result<MembershipMap> map = compute_membership(mesh, grid.tiles, tile, {.threads = 1});
      REQUIRE(map.ok());
      const std::uint64_t bad = wrong_tags(*map, tags_by_definition(expected, grid.tiles, tile));
      if (bad > 0 && wrong == 0) WARN("first wrong: case " << cases);
      wrong += bad;
      const std::uint64_t inside = std::uint64_t(std::count(expected.begin(), expected.end(), true));
      inside_voxels += inside;
      mixed += inside > 0 && inside < expected.size();

      const WindingNumber winding(mesh, 1);
      for (int p = 0; p < 100; ++p) {
        const std::uint64_t x = rng.below(size[0]), y = rng.below(size[1]), z = rng.below(size[2]);
        const bool is = winding.at({double(x) + 0.5, double(y) + 0.5, double(z) + 0.5}) != 0;
        wrong_points += is != expected[x + size[0] * (y + size[1] * z)];
      }
    }
  }
  CHECK(cases >= repetitions(10'000));
  CHECK(wrong == 0);
  CHECK(wrong_points == 0);
  // Most of them say something.
  CHECK(mixed > cases / 2);
  CHECK(inside_voxels > 100 * cases);
}
