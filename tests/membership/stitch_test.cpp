#include "sdk/membership/stitch.h"

#include <atomic>
#include <cmath>
#include <utility>

#include "sdk/core/rng.h"
#include "sdk/membership/diagnose.h"
#include "sdk/membership/orient.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

Vec3 random_vector(Rng& rng, double most) {
  Vec3 v;
  do {
    for (std::size_t a = 0; a < 3; ++a) v[a] = 2 * rng.uniform() - 1;
  } while (dot(v, v) > 1);
  return v * most;
}

void shuffle(std::vector<Triangle>& triangles, Rng& rng) {
  for (std::size_t k = triangles.size(); k > 1; --k)
    std::swap(triangles[k - 1], triangles[std::size_t(rng.uniform() * double(k))]);
}

/// Every triangle by itself, its corners moved by up to `gap` / 2, in random order, some turned.
TriangleMesh explode(const TriangleMesh& mesh, double gap, Rng& rng, bool turn) {
  TriangleMesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto first = std::uint32_t(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(mesh.vertices[v] + random_vector(rng, gap / 2));
    soup.triangles.push_back({first, first + 1, first + 2});
    if (turn && rng.uniform() < 0.4) std::swap(soup.triangles.back()[0], soup.triangles.back()[1]);
  }
  shuffle(soup.triangles, rng);
  return soup;
}

/// The unit box whose top is divided into n × n squares, though its sides are not.
TriangleMesh box_of_finer_top(std::uint32_t n, double gap, Rng& rng) {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return mesh.vertices[t[0]].z == 1 && mesh.vertices[t[1]].z == 1 && mesh.vertices[t[2]].z == 1;
  });
  const auto first = std::uint32_t(mesh.vertices.size());
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x)
      mesh.vertices.push_back(Vec3{double(x) / n, double(y) / n, 1} + random_vector(rng, gap));
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = first + x + (n + 1) * y;
      mesh.triangles.push_back({v, v + 1, v + n + 2});
      mesh.triangles.push_back({v, v + n + 2, v + n + 1});
    }
  shuffle(mesh.triangles, rng);
  return mesh;
}

bool same(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles && a.colors == b.colors;
}

double farthest_moved(const TriangleMesh& before, const TriangleMesh& after) {
  double most = 0;
  for (std::size_t v = 0; v < before.vertices.size(); ++v)
    most = std::max(most, length(after.vertices[v] - before.vertices[v]));
  return most;
}

}  // namespace

TEST_CASE("cracks that are narrower than the tolerance are closed") {
  Rng rng(5);
  const TriangleMesh sphere = make_sphere({1, 2, 3}, 1, 16);
  for (const double gap : {0.0, 1e-6, 1e-4, 1e-3})
    for (const bool turn : {false, true}) {
      const TriangleMesh soup = explode(sphere, gap, rng, turn);
      CAPTURE(gap, turn);
      const StitchedMesh out = stitch(soup, {.tolerance = std::max(gap, 1e-9)});
      CHECK(out.inserted_vertices == 0);
      CHECK(out.stitched_edges == (gap > 0 ? sphere.triangles.size() * 3 : 0));
      CHECK(out.largest_move <= gap);
      CHECK(out.largest_move == farthest_moved(soup, out.mesh));
      const OrientedMesh oriented = orient(out.mesh);
      CHECK(oriented.closed);
      CHECK(oriented.components == 1);
      CHECK(signed_volume(oriented.mesh) == Approx(signed_volume(sphere)).epsilon(20 * gap + 1e-12));
    }
}

TEST_CASE("an edge that runs along several is cut at their vertices") {
  Rng rng(6);
  for (const std::uint32_t n : {2u, 3u, 7u, 40u})
    for (const double gap : {0.0, 1e-7, 1e-5}) {
      CAPTURE(n, gap);
      const TriangleMesh mesh = box_of_finer_top(n, gap, rng);
      const StitchedMesh out = stitch(mesh, {.tolerance = 2e-5});
      CHECK(out.inserted_vertices == 4 * (n - 1));
      CHECK(out.stitched_edges == 8 * n);
      CHECK(out.largest_move <= 2e-5);
      const OrientedMesh oriented = orient(out.mesh);
      CHECK(oriented.closed);
      CHECK(oriented.turned == 0);
      CHECK(signed_volume(oriented.mesh) == Approx(1).epsilon(10 * gap + 1e-12));
    }
}

TEST_CASE("bricks whose edges overlap in turn are stitched at both ends") {
  // A band of squares around a prism, the upper row shifted against the lower.
  TriangleMesh mesh;
  const auto quad = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const auto v = std::uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
    mesh.triangles.push_back({v, v + 1, v + 2});
    mesh.triangles.push_back({v, v + 2, v + 3});
  };
  for (int k = 0; k < 4; ++k) {
    quad({double(k), 0, 0}, {k + 1.0, 0, 0}, {k + 1.0, 1, 0}, {double(k), 1, 0});
    quad({k + 0.5, 1, 0}, {k + 1.5, 1, 0}, {k + 1.5, 2, 0}, {k + 0.5, 2, 0});
  }
  const StitchedMesh out = stitch(mesh);
  CHECK(out.inserted_vertices == 8);
  CHECK(out.stitched_edges == 14);
  CHECK(out.largest_move == 0);
  const MeshDiagnosis after = diagnose(out.mesh, {DiagnosisDepth::kTopology});
  CHECK(after.components == 1);
  CHECK(after.misoriented_edges == 0);
}

TEST_CASE("what is farther apart than the tolerance stays as it is") {
  Rng rng(7);
  const TriangleMesh soup = explode(make_sphere({0, 0, 0}, 1, 10), 0, rng, false);
  TriangleMesh apart = soup;
  for (const Triangle& t : apart.triangles) {
    const Vec3 centre = (soup.vertices[t[0]] + soup.vertices[t[1]] + soup.vertices[t[2]]) / 3;
    for (const std::uint32_t v : t) apart.vertices[v] = centre + (apart.vertices[v] - centre) * 0.95;
  }
  const StitchedMesh out = stitch(apart, {.tolerance = 1e-3});
  CHECK(same(out.mesh, apart));
  CHECK(out.stitched_edges == 0);

  // A slit in a sheet, of two edges each side: nothing to pair up where it is wide.
  TriangleMesh open = make_sphere({0, 0, 0}, 1, 10);
  open.triangles.resize(open.triangles.size() - 3);
  CHECK(same(stitch(open).mesh, open));
}

TEST_CASE("a closed mesh is left alone, whatever the tolerance") {
  for (const double tolerance : {0.0, 1.0, 1e300}) {
    const TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 12);
    const StitchedMesh out = stitch(sphere, {.tolerance = tolerance});
    CHECK(same(out.mesh, sphere));
    CHECK(out.stitched_edges == 0);
  }
  CHECK(stitch({}).mesh.triangles.empty());
}

TEST_CASE("a tolerance beyond the edges themselves makes no triangle lose its area") {
  Rng rng(8);
  for (int round = 0; round < 40; ++round) {
    TriangleMesh soup;
    const double size = rng.uniform() * 0.5;
    for (std::uint32_t t = 0; t < 60; ++t) {
      const Vec3 place = random_vector(rng, 1);
      for (int k = 0; k < 3; ++k) soup.vertices.push_back(place + random_vector(rng, size));
      soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const double tolerance = rng.uniform();
    const StitchedMesh out = stitch(soup, {.tolerance = tolerance});
    CHECK(out.largest_move <= tolerance);
    CHECK(farthest_moved(soup, out.mesh) <= out.largest_move);
    CHECK(diagnose(out.mesh).degenerate_triangles == 0);
  }
}

TEST_CASE("vertices in a chain do not become one over more than the tolerance") {
  // Three edges side by side, each near the next: the outer two are too far apart.
  TriangleMesh mesh;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double y = 0.8e-3 * k;
    mesh.vertices.insert(mesh.vertices.end(), {{0, y, 0}, {1, y, 0}, {0.5, y, k == 1 ? -1.0 : 1.0 + k}});
    mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const StitchedMesh out = stitch(mesh, {.tolerance = 1e-3});
  CHECK(out.stitched_edges == 2);
  CHECK(farthest_moved(mesh, out.mesh) <= 1e-3);
}

TEST_CASE("stitching can be cancelled") {
  Rng rng(9);
  const TriangleMesh soup = explode(make_sphere({0, 0, 0}, 1, 10), 1e-4, rng, false);
  const std::atomic<bool> cancel = true;
  const Progress progress{{}, &cancel};
  const StitchedMesh out = stitch(soup, {.tolerance = 1e-4}, &progress);
  CHECK(out.interrupted);
  CHECK(same(out.mesh, soup));
  CHECK(orient(soup, &progress).interrupted);
}
