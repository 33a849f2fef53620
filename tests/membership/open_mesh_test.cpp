#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/membership/cap.h"
#include "sdk/membership/diagnose.h"
#include "sdk/membership/membership.h"
#include "sdk/membership/mesh_topology.h"
#include "sdk/membership/open_solid.h"
#include "tests/support/catch.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// The generalized winding number from its definition: all solid angles, in long double. The point is moved a
/// little into the direction that counts for points on the surface.
long double winding_by_definition(const TriangleMesh& mesh, Vec3 p) {
  constexpr long double kMove[3] = {1e-6L, 1e-9L, 1e-12L};
  long double sum = 0;
  using V = std::array<long double, 3>;
  const auto dot3 = [](const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  for (const Triangle& t : mesh.triangles) {
    V v[3];
    long double l[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& u = mesh.vertices[t[k]];
      for (std::size_t a = 0; a < 3; ++a) v[k][a] = (long double)(u[a]) - p[a] - kMove[a];
      l[k] = std::sqrt(dot3(v[k], v[k]));
    }
    const V cross{v[1][1] * v[2][2] - v[1][2] * v[2][1], v[1][2] * v[2][0] - v[1][0] * v[2][2],
                  v[1][0] * v[2][1] - v[1][1] * v[2][0]};
    sum += 2 * std::atan2(dot3(v[0], cross), l[0] * l[1] * l[2] + dot3(v[0], v[1]) * l[2] +
                                                 dot3(v[1], v[2]) * l[0] + dot3(v[2], v[0]) * l[1]);
  }
  return sum / (4 * std::numbers::pi_v<long double>);
}

struct Compared {
  std::uint64_t wrong = 0, ties = 0, inside = 0, unsure = 0;
};

/// Compares every voxel of a grid of n tiles of 4³ voxels.
Compared compare(const TriangleMesh& mesh, std::uint32_t tiles) {
  const TileMap tile = single_voxel_cells({4, 4, 4});
  MembershipReport report;
  const Result<MembershipMap> map = compute_membership(mesh, {tiles, tiles, tiles}, tile, {}, &report);
  REQUIRE(map.ok());
  Compared c;
  c.unsure = report.unsure_voxels;
  const std::vector<bool> found = inside_voxels(*map, tile);
  std::size_t voxel = 0;
  for (std::uint32_t z = 0; z < 4 * tiles; ++z)
    for (std::uint32_t y = 0; y < 4 * tiles; ++y)
      for (std::uint32_t x = 0; x < 4 * tiles; ++x) {
        const bool inside = found[voxel++];
        const long double w = std::abs(winding_by_definition(mesh, {x + 0.5, y + 0.5, z + 0.5}));
        if (std::abs(w - 0.5L) < 1e-5L)
          ++c.ties;
        else
          c.wrong += inside != (w > 0.5L);
        c.inside += inside;
      }
  return c;
}

}  // namespace

TEST_CASE("inside an open mesh is where its generalized winding number exceeds one half") {
  Rng rng(99);
  std::uint64_t unsure = 0;
  for (int round = 0; round < 16; ++round) {
    const double size = 24;
    TriangleMesh mesh = round % 3 == 0   ? make_sphere({12.3, 11.8, 12.1}, 9.7, 12)
                        : round % 3 == 1 ? make_torus({12, 12, 12}, 7, 3.4, 24, 12)
                                         : make_box({4, 3.5, 5}, {20.5, 19, 18});
    if (round % 4 == 3) append(mesh, make_sphere({9, 13, 12}, 5, 8));
    // A hole of neighbouring triangles, or triangles here and there, and some turned.
    const Vec3 at{rng.uniform(0, size), rng.uniform(0, size), rng.uniform(0, size)};
    std::vector<Triangle> kept;
    for (Triangle t : mesh.triangles) {
      const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
      if (round % 2 ? length(middle - at) < 11 : rng.below(12) == 0) continue;
      if (round % 8 == 7 && rng.below(20) == 0) std::swap(t[1], t[2]);
      kept.push_back(t);
    }
    mesh.triangles = kept;
    // Cracks: corners that lie beside each other, not on each other.
    if (round % 5 == 4) {
      TriangleMesh cracked;
      for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t)
          cracked.vertices.push_back(mesh.vertices[v] +
                                     Vec3{rng.uniform(), rng.uniform(), rng.uniform()} * 1e-3);
        const std::uint32_t n = std::uint32_t(cracked.vertices.size());
        cracked.triangles.push_back({n - 3, n - 2, n - 1});
      }
      mesh = cracked;
    }
    CAPTURE(round);
    const Compared c = compare(mesh, 6);
    CHECK(c.wrong == 0);
    CHECK(c.ties < 40);
    CHECK(c.inside > 100);
    unsure += c.unsure;
  }
  CHECK(unsure > 100);
}

TEST_CASE("inside a bowl whose rim is no plane curve is where its winding number exceeds one half") {
  // What covers it is then far from where its winding number is one half, so that whole blocks of voxels off
  // the cover are on either side.
  TriangleMesh mesh = make_sphere({20, 20, 20}, 17, 14);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 d = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3 - Vec3{20, 20, 20};
    return d.z > 9 * std::sin(2 * std::atan2(d.y, d.x));
  });
  const Compared c = compare(mesh, 10);
  CHECK(c.wrong == 0);
  CHECK(c.ties < 40);
  CHECK(c.inside > 5000);
}

TEST_CASE("what closes an open mesh does not matter, and away from its holes nothing is evaluated") {
  TriangleMesh mesh = make_sphere({64, 64, 64}, 50, 40);
  const std::size_t all = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return length(mesh.vertices[t[0]] - Vec3{64, 64, 114}) < 12;
  });
  CHECK(mesh.triangles.size() < all);
  const auto chain = boundary_chain(merge_corners(mesh));
  CHECK(!chain.empty());
  const OpenSolid open(mesh, chain, {128, 128, 128});
  CHECK(diagnose(open.closed()).closed());
  CHECK(open.evaluated_voxels() > 0);
  CHECK(open.evaluated_voxels() < 128 * 128 * 128 / 20);
  CHECK(boundary_chain(merge_corners(make_sphere({64, 64, 64}, 50, 40))).empty());
}
