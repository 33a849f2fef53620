#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/membership/membership.h"
#include "tests/support/catch.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// The same surface in other words: vertices in another order, triangles in another order, each begun at
/// another of its corners.
TriangleMesh shuffled(const TriangleMesh& mesh, Rng& rng) {
  const auto order = [&](std::size_t n) {
    std::vector<std::uint32_t> o(n);
    std::iota(o.begin(), o.end(), 0u);
    for (std::uint32_t k = std::uint32_t(n); k > 1; --k) std::swap(o[k - 1], o[rng.below(k)]);
    return o;
  };
  const std::vector<std::uint32_t> place = order(mesh.vertices.size());
  TriangleMesh out;
  out.vertices.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < place.size(); ++v) out.vertices[place[v]] = mesh.vertices[v];
  for (const std::uint32_t t : order(mesh.triangles.size())) {
    Triangle triangle = mesh.triangles[t];
    for (std::uint32_t& v : triangle) v = place[v];
    std::rotate(triangle.begin(), triangle.begin() + std::ptrdiff_t(rng.below(3)), triangle.end());
    out.triangles.push_back(triangle);
  }
  return out;
}

TriangleMesh moved(TriangleMesh mesh, Vec3 by) {
  for (Vec3& v : mesh.vertices) v = v + by;
  return mesh;
}

/// By 90° about the z axis through the middle of a grid of n voxels.
TriangleMesh rotated(TriangleMesh mesh, double n) {
  for (Vec3& v : mesh.vertices) v = {n - v.y, v.x, v.z};
  return mesh;
}

constexpr Index3 kTiles{6, 6, 6}, kResolution{8, 8, 8};
constexpr std::uint32_t kSize = 48;

std::vector<bool> inside(const TriangleMesh& mesh, const MembershipOptions& options = {}) {
  const TileMap tile = single_voxel_cells(kResolution);
  const Result<MembershipMap> map = compute_membership(mesh, kTiles, tile, options);
  REQUIRE(map.ok());
  return inside_voxels(*map, tile);
}

/// Closed and open ones, of coordinates that are multiples of 2^-20, so that moving them by whole voxels is
/// exact.
std::vector<TriangleMesh> meshes() {
  Rng rng(4);
  std::vector<TriangleMesh> all{make_torus({24, 24, 24}, 13, 6, 40, 20), make_sphere({24, 25, 23}, 17, 20),
                                make_box({8, 9.5, 10}, {30.5, 40, 31})};
  append(all[1], make_box({20, 20, 3}, {44, 30, 45}));
  TriangleMesh open = all[0];
  std::erase_if(open.triangles, [&](const Triangle&) { return rng.below(20) == 0; });
  all.push_back(open);
  for (TriangleMesh& mesh : all)
    for (Vec3& v : mesh.vertices)
      for (std::size_t a = 0; a < 3; ++a) v[a] = std::ldexp(std::nearbyint(std::ldexp(v[a], 20)), -20);
  return all;
}

}  // namespace

TEST_CASE("what is inside does not depend on the order of triangles and vertices, nor on threads") {
  Rng rng(11);
  for (const TriangleMesh& mesh : meshes()) {
    const std::vector<bool> expected = inside(mesh, {.threads = 1});
    CHECK(std::count(expected.begin(), expected.end(), true) > 5000);
    CHECK(inside(mesh, {.threads = 3}) == expected);
    for (int k = 0; k < 4; ++k) CHECK(inside(shuffled(mesh, rng)) == expected);
  }
}

TEST_CASE("what is inside moves with the mesh by whole voxels") {
  for (const TriangleMesh& mesh : meshes()) {
    const std::vector<bool> expected = inside(mesh);
    for (const std::array<int, 3>& by : {std::array<int, 3>{1, 0, 0}, {0, -2, 3}, {-3, 2, -1}}) {
      const std::vector<bool> found = inside(moved(mesh, {double(by[0]), double(by[1]), double(by[2])}));
      std::uint64_t wrong = 0;
      for (std::int64_t z = 3; z < kSize - 3; ++z)
        for (std::int64_t y = 3; y < kSize - 3; ++y)
          for (std::int64_t x = 3; x < kSize - 3; ++x)
            wrong += expected[std::size_t(x + kSize * (y + kSize * z))] !=
                     found[std::size_t(x + by[0] + kSize * (y + by[1] + kSize * (z + by[2])))];
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("what is inside turns with the mesh where no voxel's centre is on the surface") {
  for (const TriangleMesh& generated : meshes()) {
    // Off the centres, which the box would meet else, by what keeps the turned coordinates exact.
    const TriangleMesh mesh = moved(generated, {0x1p-7, 0x1p-8, 0x1p-9});
    const std::vector<bool> expected = inside(mesh), found = inside(rotated(mesh, kSize));
    std::uint64_t wrong = 0;
    for (std::size_t z = 0; z < kSize; ++z)
      for (std::size_t y = 0; y < kSize; ++y)
        for (std::size_t x = 0; x < kSize; ++x)
          wrong += expected[x + kSize * (y + kSize * z)] != found[(kSize - 1 - y) + kSize * (x + kSize * z)];
    CHECK(wrong == 0);
  }
}

TEST_CASE("solids that share a face partition the voxels on it") {
  const std::vector<bool> whole = inside(make_box({4.5, 4.5, 4.5}, {40.5, 40.5, 40.5}));
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double cut : {20.0, 20.5}) {
      Vec3 high{40.5, 40.5, 40.5}, low{4.5, 4.5, 4.5};
      high[axis] = low[axis] = cut;
      const std::vector<bool> a = inside(make_box({4.5, 4.5, 4.5}, high)),
                              b = inside(make_box(low, {40.5, 40.5, 40.5}));
      std::uint64_t wrong = 0;
      for (std::size_t v = 0; v < whole.size(); ++v) wrong += int(a[v]) + int(b[v]) != int(whole[v]);
      CHECK(wrong == 0);
    }
}

TEST_CASE("what is solid of shells in and over one another is as the rule says") {
  const Vec3 middle{24, 24, 24};
  const auto volume = [](const std::vector<bool>& voxels) {
    return std::uint64_t(std::count(voxels.begin(), voxels.end(), true));
  };
  const TriangleMesh big = make_sphere(middle, 18, 24), small = make_sphere(middle, 9, 24);
  TriangleMesh cavity = small;
  flip(cavity);
  const std::uint64_t outer = volume(inside(big)), inner = volume(inside(small));
  const auto solid = [&](const TriangleMesh& second, SolidRule rule) {
    TriangleMesh mesh = big;
    append(mesh, second);
    return volume(inside(mesh, {.solid = rule}));
  };
  CHECK(solid(small, SolidRule::kNonzero) == outer);
  CHECK(solid(cavity, SolidRule::kNonzero) == outer - inner);
  CHECK(solid(small, SolidRule::kEvenOdd) == outer - inner);
  CHECK(solid(cavity, SolidRule::kEvenOdd) == outer - inner);
  CHECK(solid(small, SolidRule::kOuter) == outer);
  CHECK(solid(cavity, SolidRule::kOuter) == outer);

  // Two that overlap, one of them inside out.
  const TriangleMesh left = make_box({4, 4, 4}, {24, 24, 24}), right = make_box({14, 4, 4}, {34, 24, 24});
  TriangleMesh both = left, opposed = right;
  append(both, right);
  flip(opposed);
  append(opposed, left);
  CHECK(volume(inside(both)) == 30 * 20 * 20);
  CHECK(volume(inside(both, {.solid = SolidRule::kEvenOdd})) == 20 * 20 * 20);
  CHECK(volume(inside(opposed)) == 20 * 20 * 20);
  CHECK(volume(inside(opposed, {.solid = SolidRule::kOuter})) == 30 * 20 * 20);

  // With a hole in the outer shell the rules hold for the rounded winding number.
  TriangleMesh open = big;
  open.triangles.erase(open.triangles.begin() + 500, open.triangles.begin() + 508);
  append(open, small);
  const double hollow = double(volume(inside(open, {.solid = SolidRule::kEvenOdd})));
  CHECK(hollow == Approx(double(outer - inner)).epsilon(0.01));
  CHECK(double(volume(inside(open))) == Approx(double(outer)).epsilon(0.01));
}
