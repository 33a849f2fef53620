#include "sdk/wrap/alpha_wrap.h"

#include <atomic>
#include <cmath>

#include "sdk/author/cell_object.h"
#include "sdk/core/closest_point.h"
#include "sdk/core/rng.h"
#include "sdk/membership/diagnose.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// A sphere of triangles that all hang alone, each turned at random, a tenth of them missing.
TriangleMesh torn_sphere(std::uint32_t rings) {
  const TriangleMesh sphere = make_sphere({1, 2, 3}, 1, rings);
  Rng rng(3);
  TriangleMesh soup;
  for (const Triangle& t : sphere.triangles) {
    if (rng.uniform() < 0.1) continue;
    const auto first = std::uint32_t(soup.vertices.size());
    const Vec3 off{rng.uniform(-0.004, 0.004), rng.uniform(-0.004, 0.004), rng.uniform(-0.004, 0.004)};
    for (const std::uint32_t v : t) soup.vertices.push_back(sphere.vertices[v] + off);
    soup.triangles.push_back({first, first + 1, first + 2});
    if (rng.uniform() < 0.5) std::swap(soup.triangles.back()[0], soup.triangles.back()[1]);
  }
  return soup;
}

}  // namespace

TEST_CASE("a wrap is closed, lies outside of what it wraps and near it") {
  const TriangleMesh soup = torn_sphere(24);
  const double alpha = 0.3, offset = 0.05;
  const Result<TriangleMesh> wrap = alpha_wrap(soup, alpha, offset);
  REQUIRE(wrap.ok());
  const MeshDiagnosis d = diagnose(*wrap, {DiagnosisDepth::kGeometry});
  CHECK(findings(d).empty());
  CHECK(d.closed());
  CHECK(d.components == 1);
  CHECK(signed_volume(*wrap) > 4.1);
  CHECK(signed_volume(*wrap) < 4.19 * 1.06 * 1.06 * 1.06);
  const ClosestPoint surface(soup);
  for (const Vec3& v : wrap->vertices) {
    const double distance = surface.query(v).distance;
    CHECK(distance > 0);
    CHECK(distance < 2 * offset);
    CHECK(length(v - Vec3{1, 2, 3}) > 0.98);
  }
  const Result<TriangleMesh> again = alpha_wrap(soup, alpha, offset);
  REQUIRE(again.ok());
  CHECK(again->vertices == wrap->vertices);
  CHECK(again->triangles == wrap->triangles);
}

TEST_CASE("a soup that has no winding number to speak of becomes solid by its wrap") {
  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=8"));
  AuthorOptions options{.grid = {.tiles = 4}};
  options.repair.repair = Repair::kWinding;
  const TriangleMesh soup = torn_sphere(10);
  CHECK(author_cell_object(soup, tile, options).error().id == "mesh-bounds-nothing");
  options.repair.repair = Repair::kAuto;
  options.repair.wrapper = alpha_wrap;
  options.repair.wrap_alpha = 0.4;
  AuthorReport report;
  REQUIRE(author_cell_object(soup, tile, options, &report).ok());
  CHECK(report.repair.rung == RepairRung::kWrap);
  CHECK(report.inside_volume > 1);
  CHECK(report.inside_volume < report.mesh_volume);
}

TEST_CASE("what cannot be wrapped is refused, and wrapping can be cancelled") {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    CHECK(alpha_wrap(box, bad, 0.1).error().code == ErrorCode::kUsage);
    CHECK(alpha_wrap(box, 0.1, bad).error().code == ErrorCode::kUsage);
  }
  CHECK(alpha_wrap({}, 1, 1).error().code == ErrorCode::kInvalidInput);
  CHECK(alpha_wrap({{{1, 1, 1}}, {{0, 0, 0}}}, 1, 1).error().code == ErrorCode::kInvalidInput);
  std::atomic<bool> cancel = false;
  int reports = 0;
  const Progress progress{[&](std::string_view, double fraction) {
                            CHECK(fraction < 1);
                            if (++reports == 2) cancel = true;
                          },
                          &cancel};
  CHECK(alpha_wrap(box, 0.01, 0.001, &progress).error().code == ErrorCode::kCancelled);
  CHECK(reports == 2);
}
