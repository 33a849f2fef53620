#include "sdk/core/closest_point.h"

#include <chrono>
#include <cmath>
#include <limits>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

using Wide = std::array<long double, 3>;

Wide minus(Vec3 a, Vec3 b) {
  return {(long double)a.x - b.x, (long double)a.y - b.y, (long double)a.z - b.z};
}
long double dot(const Wide& a, const Wide& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

long double from_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Wide ap = minus(p, a), ab = minus(b, a);
  const long double squared = dot(ab, ab);
  const long double t =
      squared > 0 ? std::min<long double>(std::max<long double>(dot(ap, ab) / squared, 0), 1) : 0;
  const Wide d{ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]};
  return std::sqrt(dot(d, d));
}

/// By the Gram matrix of the edges, in long double.
long double from_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  long double best = std::min({from_segment(p, a, b), from_segment(p, b, c), from_segment(p, c, a)});
  const Wide ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
  const long double g11 = dot(ab, ab), g12 = dot(ab, ac), g22 = dot(ac, ac), r1 = dot(ap, ab),
                    r2 = dot(ap, ac);
  const long double det = g11 * g22 - g12 * g12;
  if (!(det > 1e-12L * g11 * g22)) return best;
  const long double v = (r1 * g22 - r2 * g12) / det, w = (r2 * g11 - r1 * g12) / det;
  if (v < 0 || w < 0 || v + w > 1) return best;
  const Wide d{ap[0] - v * ab[0] - w * ac[0], ap[1] - v * ab[1] - w * ac[1], ap[2] - v * ab[2] - w * ac[2]};
  return std::min(best, std::sqrt(dot(d, d)));
}

Vec3 random_point(Rng& rng, Vec3 centre, double half) {
  return centre + Vec3{rng.uniform(-half, half), rng.uniform(-half, half), rng.uniform(-half, half)};
}

/// Triangles of all sizes; a third of them are points, segments, needles, copies of others or neighbours of
/// them.
TriangleMesh random_soup(Rng& rng, Vec3 centre, std::uint32_t count) {
  TriangleMesh mesh;
  for (std::uint32_t t = 0; t < count; ++t) {
    const double size = std::ldexp(1.0, -int(rng.below(12)));
    const Vec3 at = random_point(rng, centre, 1);
    Vec3 a = random_point(rng, at, size), b = random_point(rng, at, size), c = random_point(rng, at, size);
    const std::uint32_t kind = rng.below(15);
    if (kind == 0) b = c = a;
    if (kind == 1) c = b;
    if (kind == 2) c = a + (b - a) * rng.uniform(-1, 2);
    if (kind == 3) c = b + (c - b) * 1e-9;
    if (t > 0 && kind == 4) {
      mesh.triangles.push_back(mesh.triangles[rng.below(t)]);
      continue;
    }
    const std::uint32_t v = std::uint32_t(mesh.vertices.size());
    Triangle triangle{v, v + 1, v + 2};
    if (t > 0 && kind >= 5 && kind < 8) {
      const Triangle other = mesh.triangles[rng.below(t)];
      triangle = {other[1], other[0], v + 2};
    }
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

const std::array<Vec3, 3> kCentres = {{{0, 0, 0}, {1e6, -2e6, 3e6}, {1e6, 0, 0}}};

/// Checks what holds of any answer.
void check_answer(const TriangleMesh& mesh, Vec3 p, const SurfacePoint& found, double ulp) {
  const Triangle& t = mesh.triangles[found.triangle];
  Vec3 combined;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK((found.barycentric[k] >= 0 && found.barycentric[k] <= 1));
    combined = combined + (mesh.vertices[t[k]] - mesh.vertices[t[0]]) * found.barycentric[k];
    sum += found.barycentric[k];
  }
  CHECK(std::abs(sum - 1) < 1e-15);
  CHECK(length(combined + mesh.vertices[t[0]] - found.point) <= 8 * ulp);
  CHECK(found.distance == length(found.point - p));
}

}  // namespace

TEST_CASE("closest points are those of a search through all triangles") {
  Rng rng(1);
  for (const Vec3 centre : kCentres)
    for (const std::uint32_t count : {1u, 2u, 5u, 40u, 700u}) {
      const TriangleMesh mesh = random_soup(rng, centre, count);
      const ClosestPoint closest(mesh);
      const double ulp = (1 + std::abs(centre.x) + std::abs(centre.y) + std::abs(centre.z)) *
                         std::numeric_limits<double>::epsilon();
      for (int k = 0; k < 300; ++k) {
        // Near the surface, on it, at vertices, about the soup and far from it.
        const Triangle& t = mesh.triangles[rng.below(count)];
        Vec3 p = random_point(rng, centre, k % 3 == 0 ? 2 : 1e-3);
        if (k % 3 == 1) p = mesh.vertices[t[0]];
        if (k % 3 == 2)
          p = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3 +
              random_point(rng, {}, k % 2 == 0 ? 0 : 1e-3);
        if (k % 50 == 0) p = random_point(rng, centre, 1e4);
        const SurfacePoint found = closest.query(p);
        long double truth = std::numeric_limits<long double>::infinity();
        for (const Triangle& s : mesh.triangles)
          truth = std::min(truth,
                           from_triangle(p, mesh.vertices[s[0]], mesh.vertices[s[1]], mesh.vertices[s[2]]));
        INFO("centre " << centre.x << " count " << count << " k " << k);
        check_answer(mesh, p, found, ulp);
        const double tolerance = 16 * ulp + 1e-14 * double(truth) + (k % 50 == 0 ? 1e-11 : 0);
        CHECK(std::abs(found.distance - double(truth)) <= tolerance);
      }
    }
}

TEST_CASE("the tree loses nothing: the answer is the best of each triangle's own, ties to the lowest index") {
  Rng rng(2);
  for (const Vec3 centre : kCentres) {
    const TriangleMesh mesh = random_soup(rng, centre, 300);
    const ClosestPoint closest(mesh);
    std::vector<ClosestPoint> single;
    for (const Triangle& t : mesh.triangles) single.emplace_back(TriangleMesh{mesh.vertices, {t}});
    int ties = 0;
    for (int k = 0; k < 1000; ++k) {
      const Vec3 p = random_point(rng, centre, 1.5);
      SurfacePoint best{{}, std::numeric_limits<double>::infinity(), 0, {}};
      for (std::uint32_t t = 0; t < single.size(); ++t) {
        const SurfacePoint own = single[t].query(p);
        ties += own.distance == best.distance;
        if (own.distance < best.distance) {
          best = own;
          best.triangle = t;
        }
      }
      const SurfacePoint found = closest.query(p);
      CHECK(found.triangle == best.triangle);
      CHECK(found.distance == best.distance);
      CHECK(found.point == best.point);
      CHECK(found.barycentric == best.barycentric);
    }
    CHECK(ties > 100);
  }
}

TEST_CASE("beside an edge or a vertex the lowest of its triangles is found, in any order of the mesh") {
  const TriangleMesh cube = make_box({-1, -1, -1}, {1, 1, 1});
  Rng rng(3);
  for (int turn = 0; turn < 20; ++turn) {
    TriangleMesh mesh = cube;
    for (std::uint32_t t = 11; t > 0; --t) std::swap(mesh.triangles[t], mesh.triangles[rng.below(t + 1)]);
    for (Triangle& t : mesh.triangles)
      if (rng.below(2) == 0) t = {t[1], t[2], t[0]};
    const ClosestPoint closest(mesh);
    const auto lowest_with = [&](std::initializer_list<Vec3> corners) {
      for (std::uint32_t t = 0;; ++t) {
        std::size_t has = 0;
        for (const Vec3 c : corners)
          for (const std::uint32_t v : mesh.triangles[t]) has += mesh.vertices[v] == c;
        if (has == corners.size()) return t;
      }
    };
    CHECK(closest.query({3, 4, 5}).triangle == lowest_with({{1, 1, 1}}));
    CHECK(closest.query({-1.3, -1.1, -7}).triangle == lowest_with({{-1, -1, -1}}));
    const SurfacePoint edge = closest.query({0.25, 1.7, 2.1});
    CHECK(edge.point == Vec3{0.25, 1, 1});
    CHECK(edge.triangle == lowest_with({{-1, 1, 1}, {1, 1, 1}}));
    CHECK(closest.query({1.7, 2.1, -0.77}).triangle == lowest_with({{1, 1, -1}, {1, 1, 1}}));
  }
}

TEST_CASE("meshes that defeat a split are searched all the same") {
  Rng rng(4);
  // All in one place; sizes and places that fall by halves, which would make a chain of bins.
  TriangleMesh same, chain;
  for (std::uint32_t t = 0; t < 3000; ++t) {
    append(same, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    const double s = std::ldexp(1.0, -int(t % 500));
    append(chain, {{{s, 0, 0}, {2 * s, 0, 0}, {s, s, 0}}, {{0, 1, 2}}});
  }
  const ClosestPoint in_same(same), in_chain(chain);
  CHECK(in_same.query({0.25, 0.25, 2}).distance == 2);
  CHECK(in_same.query({0.25, 0.25, 2}).triangle == 0);
  for (std::uint32_t t = 0; t < 250; ++t) {  // then squares of squares underflow
    const double s = std::ldexp(1.0, -int(t));
    const SurfacePoint found = in_chain.query({1.5 * s, 0.25 * s, s});
    CHECK(found.distance == s);
    CHECK(found.triangle == t);
  }
}

TEST_CASE("coordinates as large as a mesh may have do not overflow") {
  const double m = 1e150;
  const ClosestPoint closest({{{m, 0, 0}, {-m, 0, 0}, {0, m, 0}}, {{0, 1, 2}}});
  CHECK(closest.query({0, -m, 0}).distance == m);
  CHECK(closest.query({-m, 0, m}).distance == m);
}

TEST_CASE("answers do not depend on threads, and may be asked for from many") {
  const TriangleMesh mesh = make_torus({5, 5, 5}, 2, 1, 200, 100);
  const ClosestPoint one(mesh, 1), many(mesh, 8);
  Rng rng(5);
  std::vector<Vec3> points(5000);
  for (Vec3& p : points) p = random_point(rng, {5, 5, 5}, 4);
  std::vector<SurfacePoint> found(points.size());
  parallel_for(points.size(), 8, [&](std::size_t k, unsigned) { found[k] = many.query(points[k]); });
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SurfacePoint own = one.query(points[k]);
    CHECK(own.point == found[k].point);
    CHECK(own.triangle == found[k].triangle);
    const Vec3 d = points[k] - Vec3{5, 5, 5};
    const double ring = std::hypot(d.x, d.y) - 2;
    CHECK(own.distance == Approx(std::abs(std::hypot(ring, d.z) - 1)).margin(3e-3));
  }
}

TEST_CASE("a million triangles take about a second to build", "[.][timing]") {
  const TriangleMesh mesh = make_torus({5, 5, 5}, 2, 1, 1000, 500);
  const auto start = std::chrono::steady_clock::now();
  const ClosestPoint closest(mesh);
  const auto built = std::chrono::steady_clock::now();
  Rng rng(6);
  double sum = 0;
  for (int k = 0; k < 10000; ++k) sum += closest.query(random_point(rng, {5, 5, 5}, 4)).distance;
  const auto far = std::chrono::steady_clock::now();
  for (int k = 0; k < 100000; ++k)
    sum += closest.query(mesh.vertices[rng.below(500000)] + random_point(rng, {}, 0.1)).distance;
  const auto near = std::chrono::steady_clock::now();
  WARN("build " << std::chrono::duration<double>(built - start).count() << " s, query far away "
                << std::chrono::duration<double>(far - built).count() * 100 << " us, near "
                << std::chrono::duration<double>(near - far).count() * 10 << " us, sum " << sum);
}
