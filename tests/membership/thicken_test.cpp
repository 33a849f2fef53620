#include "sdk/membership/thicken.h"

#include <atomic>
#include <cmath>

#include "sdk/core/closest_point.h"
#include "sdk/core/rng.h"
#include "sdk/membership/diagnose.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// By solid angles [van Oosterom 1983].
double winding_number(const TriangleMesh& mesh, Vec3 p) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * 3.14159265358979323846);
}

/// Compares with the distance from the surface, at points around it.
void check_by_distance(const TriangleMesh& sheet, double thickness, std::uint64_t seed, int points) {
  const Result<ThickenedMesh> out = thicken(sheet, thickness);
  REQUIRE(out.ok());
  CHECK(diagnose(out->mesh).closed());
  CHECK(out->thickened_triangles == sheet.triangles.size());
  const ClosestPoint surface(sheet);
  Rng rng(seed);
  const double r = thickness / 2;
  int inside = 0, outside = 0;
  for (int k = 0; k < points; ++k) {
    const Triangle& t = sheet.triangles[rng.below(std::uint32_t(sheet.triangles.size()))];
    const double s = std::sqrt(rng.uniform()), u = rng.uniform();
    Vec3 p = sheet.vertices[t[0]] * (1 - s) + sheet.vertices[t[1]] * (s * (1 - u)) +
             sheet.vertices[t[2]] * (s * u);
    for (std::size_t a = 0; a < 3; ++a) p[a] += rng.uniform(-1.5 * r, 1.5 * r);
    const SurfacePoint near = surface.query(p);
    const auto [low, high] = std::minmax({near.barycentric[0], near.barycentric[1], near.barycentric[2]});
    const double winding = winding_number(out->mesh, p);
    const double reach = low > 1e-6 && high < 1 ? 1 - 1e-9 : 0.92;
    if (near.distance < reach * r) {
      CHECK(winding > 0.5);
      ++inside;
    } else if (near.distance > r * (1 + 1e-9)) {
      CHECK(std::abs(winding) < 0.5);
      ++outside;
    }
  }
  CHECK(inside > points / 10);
  CHECK(outside > points / 10);
}

TriangleMesh random_sheets(Rng& rng, std::uint32_t count, std::uint32_t vertices) {
  TriangleMesh mesh;
  for (std::uint32_t v = 0; v < vertices; ++v)
    mesh.vertices.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  while (mesh.triangles.size() < count) {
    const Triangle t{rng.below(vertices), rng.below(vertices), rng.below(vertices)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace

TEST_CASE("a thickened sheet is what is within half the thickness of it") {
  const TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  check_by_distance(triangle, 0.2, 1, 2000);
  // Bent by every angle, up and down, with triangles that agree on a side and that do not.
  for (int k = 0; k < 24; ++k) {
    const double angle = 0.3 * (k - 12);
    TriangleMesh bent{{{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}, {0.6, -std::cos(angle), std::sin(angle)}},
                      {{0, 1, 2}, {1, 0, 3}}};
    if (k % 2 != 0) std::swap(bent.triangles[1][0], bent.triangles[1][1]);
    CAPTURE(k);
    check_by_distance(bent, 0.3, std::uint64_t(k), 600);
  }
  TriangleMesh bowl = make_sphere({0, 0, 0}, 1, 12);
  std::erase_if(bowl.triangles, [&](const Triangle& t) {
    return bowl.vertices[t[0]].z + bowl.vertices[t[1]].z + bowl.vertices[t[2]].z > 0;
  });
  check_by_distance(bowl, 0.15, 2, 1500);
  check_by_distance(bowl, 1.2, 3, 500);  // thicker than it is deep
}

TEST_CASE("a thickened soup with edges of many triangles is what is near it") {
  Rng rng(4);
  for (std::uint32_t round = 0; round < 12; ++round) {
    CAPTURE(round);
    // Few vertices, so that many triangles share an edge; some are given twice.
    const TriangleMesh soup = random_sheets(rng, 3 + 2 * round, 5 + round / 3);
    const MeshDiagnosis d = diagnose(soup, {DiagnosisDepth::kTopology});
    if (d.closed_components > 0) continue;
    check_by_distance(soup, 0.1 + 0.02 * round, round, 400);
  }
}

TEST_CASE("triangles without area are as thick as the lines that they are") {
  const TriangleMesh line{{{0, 0, 0}, {1, 2, 0.5}, {2, 4, 1}}, {{0, 1, 2}}};
  const Result<ThickenedMesh> out = thicken(line, 0.2);
  REQUIRE(out.ok());
  CHECK(diagnose(out->mesh).closed());
  const ClosestPoint axis(line);
  Rng rng(5);
  for (int k = 0; k < 500; ++k) {
    const Vec3 p{rng.uniform(-0.2, 2.2), rng.uniform(-0.2, 4.2), rng.uniform(-0.2, 1.2)};
    const double d = axis.query(p).distance;
    if (d < 0.092) CHECK(winding_number(out->mesh, p) > 0.5);
    if (d > 0.1001) CHECK(std::abs(winding_number(out->mesh, p)) < 0.5);
  }
}

TEST_CASE("only what is open gets a thickness") {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  const Result<ThickenedMesh> closed = thicken(mesh, 0.1);
  REQUIRE(closed.ok());
  CHECK(closed->thickened_components == 0);
  CHECK(closed->mesh.triangles == mesh.triangles);
  append(mesh, {{{3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const Result<ThickenedMesh> out = thicken(mesh, 0.1);
  REQUIRE(out.ok());
  CHECK(out->thickened_components == 1);
  CHECK(out->thickened_triangles == 2);
  CHECK(diagnose(out->mesh).closed());
  CHECK(winding_number(out->mesh, {0.5, 0.5, 0.5}) == Approx(1));
  CHECK(winding_number(out->mesh, {3.4, 0.5, 0.04}) == Approx(1));
  CHECK(winding_number(out->mesh, {3.4, 0.5, 0.06}) == Approx(0).margin(1e-9));
  CHECK(winding_number(out->mesh, {0.5, 0.5, 1.04}) == Approx(0).margin(1e-9));
}

TEST_CASE("a thickness that is none is refused, and thickening can be cancelled") {
  const TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const double thickness : {0.0, -1.0, std::nan(""), HUGE_VAL})
    CHECK(thicken(triangle, thickness).error().code == ErrorCode::kUsage);
  const std::atomic<bool> cancel = true;
  const Progress progress{{}, &cancel};
  CHECK(thicken(triangle, 0.1, &progress).error().code == ErrorCode::kCancelled);
}
