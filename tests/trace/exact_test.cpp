#include "sdk/trace/exact.h"

#include <gmpxx.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// GMP's rational, with what the oracle asks for.
struct BigRational {
  mpq_class q = 0;
  BigRational() = default;
  BigRational(std::int64_t n, std::int64_t d) : q(mpz_class(long(n)), mpz_class(long(d))) {
    q.canonicalize();
  }
  explicit BigRational(mpq_class value) : q(std::move(value)) {}
};
BigRational operator+(const BigRational& a, const BigRational& b) {
  return BigRational(mpq_class(a.q + b.q));
}
BigRational operator*(const BigRational& a, const BigRational& b) {
  return BigRational(mpq_class(a.q * b.q));
}
bool operator<(const BigRational& a, const BigRational& b) { return a.q < b.q; }
bool operator==(const BigRational& a, const BigRational& b) { return a.q == b.q; }
std::int64_t floor_of(const BigRational& a) {
  mpz_class f;
  mpz_fdiv_q(f.get_mpz_t(), a.q.get_num_mpz_t(), a.q.get_den_mpz_t());
  return f.fits_slong_p() ? f.get_si() : f > 0 ? std::numeric_limits<long>::max() / 2 : -1;
}
double to_double(const BigRational& a) { return a.q.get_d(); }
BigRational middle(const BigRational& a, const BigRational& b) {
  return BigRational(mpq_class((a.q + b.q) / 2));
}

/// Empty if caster and oracle agree on the ray, else what differs.
template <typename Q>
std::string difference(const CellObject& object, const Caster& caster, const Ray& ray,
                       const std::array<Q, 3>& origin, const std::array<Q, 3>& direction,
                       const std::array<Q, 3>& inverse) {
  const auto expected = first_hit_by_definition(object, origin, direction, inverse);
  Hit hit;
  const bool found = caster.first_hit(ray, hit);
  if (found != expected.has_value()) return found ? "hit for a miss" : "miss for a hit";
  if (!found) return "";
  if (hit.element != expected->voxel) return "wrong voxel";
  const double t = to_double(expected->t);
  if (!(std::abs(hit.t - t) <= 1e-12 * (1 + std::abs(t)))) return "wrong t";
  bool starts_inside = true;
  for (std::size_t a = 0; a < 3; ++a) {
    if (hit.face_normal[a] == 0) continue;
    starts_inside = false;
    if (!expected->axes[a] || hit.face_normal[a] * ray.direction[a] >= 0) return "wrong face";
  }
  if (starts_inside && t != 0) return "no face";
  return "";
}

/// A ray whose coordinates are integers / 2^shift and small integers.
struct IntegerRay {
  std::array<std::int64_t, 3> origin{}, direction{};
  unsigned shift = 0;
};

IntegerRay random_ray(Rng& rng, const CellObject& object) {
  IntegerRay r;
  const std::uint32_t kind = rng.below(6);
  r.shift = kind < 3 ? rng.below(3) : 16;
  const std::int64_t unit = std::int64_t{1} << r.shift;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t n = std::int64_t(object.grid.tiles[a]) * object.tile.resolution[a];
    // From well before the grid to well behind it; half of the rays begin within.
    const std::int64_t room = rng.below(2) ? 0 : n;
    r.origin[a] = std::int64_t(rng.bits(32) * std::uint64_t((n + 2 * room) * unit) >> 32) - room * unit;
    switch (kind) {
      case 0:
        r.direction[a] = 0;
        break;  // along an axis, see below
      case 1:
        r.direction[a] = std::int64_t(rng.below(3)) - 1;
        break;  // through edges and corners
      case 2:
        r.direction[a] = std::int64_t(rng.below(9)) - 4;
        break;
      case 3:
        r.direction[a] = std::int64_t(rng.below(2048)) - 1024;
        break;
      case 4:
        r.direction[a] = std::int64_t(rng.below(7)) - 3;
        break;  // grazing, see below
      default:
        r.direction[a] = (std::int64_t(rng.below(2048)) - 1024) * (rng.below(8) != 0);
        break;
    }
  }
  const std::size_t axis = rng.below(3);
  if (kind == 0) r.direction[axis] = rng.below(2) ? 1 : -1;
  if (kind == 4) r.direction[axis] = rng.below(2) ? 1000 : -1000;
  if (r.direction == std::array<std::int64_t, 3>{}) r.direction[axis] = 1;
  if (rng.below(4) == 0)  // far away, aimed back at where it was
    for (std::size_t a = 0; a < 3; ++a) r.origin[a] -= 100 * unit * r.direction[a];
  return r;
}

std::string check_integer_ray(const CellObject& object, const Caster& caster, const IntegerRay& r) {
  const std::int64_t unit = std::int64_t{1} << r.shift;
  std::array<WideRational, 3> origin, direction, inverse;
  Ray ray;
  for (std::size_t a = 0; a < 3; ++a) {
    origin[a] = {r.origin[a], unit};
    direction[a] = {r.direction[a], 1};
    if (r.direction[a] != 0) inverse[a] = {1, r.direction[a]};
    ray.origin[a] = double(r.origin[a]) / double(unit);
    ray.direction[a] = double(r.direction[a]);
  }
  return difference(object, caster, ray, origin, direction, inverse);
}

void check_random_rays(const std::string& recipe, const Index3& tiles, double share, std::uint64_t seed,
                       std::size_t rays) {
  Rng rng(seed);
  const CellObject object = random_object(rng, recipe, tiles, share);
  const auto caster = make_exact_caster(object);
  std::atomic<std::size_t> wrong{0}, hits{0};
  parallel_for(rays / 1000, 0, [&](std::size_t chunk, unsigned) {
    Rng own(seed * 1000003 + chunk);
    for (int k = 0; k < 1000; ++k) {
      const IntegerRay r = random_ray(own, object);
      wrong += !check_integer_ray(object, *caster, r).empty();
      Hit hit;
      const double unit = double(std::int64_t{1} << r.shift);
      hits += caster->first_hit(
          {{double(r.origin[0]) / unit, double(r.origin[1]) / unit, double(r.origin[2]) / unit},
           {double(r.direction[0]), double(r.direction[1]), double(r.direction[2])}},
          hit);
    }
  });
  CHECK(wrong == 0);
  CHECK(hits > rays / 20);
  CHECK(hits < rays);
}

}  // namespace

TEST_CASE("exact tracing equals the definition on a million rays of integers") {
  check_random_rays("voronoi:cells=4,resolution=8,seed=1", {3, 3, 3}, 0.1, 1, 250000);
  check_random_rays("spheres:cells=3,resolution=11,seed=2", {2, 3, 1}, 0.6, 2, 250000);
  check_random_rays("voronoi:cells=40,resolution=7x9x5,seed=3", {2, 2, 4}, 0.05, 3, 250000);
  check_random_rays("voronoi:cells=1,resolution=6,seed=4", {4, 4, 4}, 0.4, 4, 250000);
}

TEST_CASE("exact tracing equals the definition on rays of arbitrary doubles") {
  Rng rng(5);
  const CellObject object = random_object(rng, "voronoi:cells=5,resolution=8,seed=6", {3, 2, 3}, 0.2);
  const auto caster = make_exact_caster(object);
  int hits = 0;
  for (int k = 0; k < 5000; ++k) {
    Ray ray;
    const double reach = std::ldexp(1.0, int(rng.below(24)));  // up to a million tiles away
    const double slope = std::ldexp(1.0, -int(rng.below(60)));
    for (std::size_t a = 0; a < 3; ++a) {
      ray.direction[a] = rng.uniform(-1, 1) * (rng.below(3) == 0 ? slope : 1);
      // A lattice point, or a point anywhere, then back along the ray: rounding leaves it just beside.
      const double target = rng.below(2) ? rng.below(24) : rng.uniform(0, 24);
      ray.origin[a] = target - ray.direction[a] * reach;
    }
    std::array<BigRational, 3> origin, direction, inverse;
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = BigRational(mpq_class(ray.origin[a]));
      direction[a] = BigRational(mpq_class(ray.direction[a]));
      if (ray.direction[a] != 0) inverse[a] = BigRational(mpq_class(1 / mpq_class(ray.direction[a])));
    }
    const std::string what = difference(object, *caster, ray, origin, direction, inverse);
    INFO(what << " at ray " << k);
    REQUIRE(what.empty());
    Hit hit;
    hits += caster->first_hit(ray, hit);
  }
  CHECK(hits > 500);
}

TEST_CASE("a ray that is none is a miss") {
  Rng rng(6);
  const CellObject object = random_object(rng, "voronoi:cells=2,resolution=8", {2, 2, 2}, 1);
  const auto caster = make_exact_caster(object);
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  Hit hit;
  CHECK_FALSE(caster->first_hit({{1, 1, 1}, {0, 0, 0}}, hit));
  CHECK_FALSE(caster->first_hit({{1, 1, 1}, {nan, 0, 1}}, hit));
  CHECK_FALSE(caster->first_hit({{1, nan, 1}, {0, 0, 1}}, hit));
  CHECK_FALSE(caster->first_hit({{1, 1, 1}, {inf, 0, 1}}, hit));
  CHECK_FALSE(caster->first_hit({{-inf, 1, 1}, {1, 0, 0}}, hit));
  CHECK_FALSE(caster->first_hit({{-1e300, 1, 1}, {1, 0, 0}}, hit));
}

TEST_CASE("t is in metres for a unit direction, whatever the grid's place and size") {
  Rng rng(7);
  CellObject object = random_object(rng, "voronoi:cells=3,resolution=8", {3, 3, 3}, 0.3);
  const auto unit = make_exact_caster(object);
  object.grid.voxel_edge = 0.125;
  object.grid.box_min = {-5, 3, 100};
  const auto moved = make_exact_caster(object);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 o{rng.uniform(-10, 34), rng.uniform(-10, 34), -10};
    const Vec3 d = normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), 1});
    Hit a, b;
    const bool hit = unit->first_hit({o, d}, a);
    REQUIRE(moved->first_hit({o * 0.125 + Vec3{-5, 3, 100}, d}, b) == hit);
    if (hit) CHECK(b.t == Approx(a.t * 0.125));
  }
}
