#include "sdk/trace/exact.h"

#include <gmpxx.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/sanitized.h"

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

/// What the definition says of a ray.
struct Truth {
  bool hit = false;
  double t = 0;
  Voxel voxel{};
  int face = -1;
  OracleInstance instance;
};

template <typename Q>
Truth truth_of(const CellObject& object, const std::array<Q, 3>& origin, const std::array<Q, 3>& direction,
               const std::array<Q, 3>& inverse) {
  const auto hit = first_hit_by_definition(object, origin, direction, inverse);
  if (!hit) return {};
  return {true, to_double(hit->t), hit->voxel, hit->face, *instance_at(object, hit->voxel)};
}

bool same_t(double t, double true_t) { return std::abs(t - true_t) <= 1e-12 * (1 + std::abs(true_t)); }

// Ways to ask a caster. Each says of every ray what differs, or nothing.
using Answers = std::vector<std::string>;

struct AskFirstHit {
  static Answers differences(const Caster& caster, std::span<const Ray> rays, std::span<const Truth> truths) {
    Answers out(rays.size());
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const Truth& truth = truths[k];
      Hit hit;
      const bool found = caster.first_hit(rays[k], hit);
      Vec3 normal;
      if (truth.face >= 0) normal[std::size_t(truth.face / 2)] = truth.face % 2 ? 1 : -1;
      if (found != truth.hit) out[k] = found ? "hit for a miss" : "miss for a hit";
      if (!found || !truth.hit) continue;
      if (hit.element != truth.voxel)
        out[k] = "wrong voxel";
      else if (!same_t(hit.t, truth.t))
        out[k] = "wrong t";
      else if (!(hit.face_normal == normal))
        out[k] = "wrong face";
      else if (hit.label != truth.instance.cell || hit.instance != truth.instance.home)
        out[k] = "wrong instance";
    }
    return out;
  }
};

struct AskFirstHits {
  static Answers differences(const Caster& caster, std::span<const Ray> rays, std::span<const Truth> truths) {
    Answers out(rays.size());
    std::vector<StreamHit> hits(rays.size());
    caster.first_hits(rays, hits);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const Truth& truth = truths[k];
      const StreamHit& hit = hits[k];
      const Voxel voxel{hit.element[0], hit.element[1], hit.element[2]};
      if (hit.hit() != truth.hit) out[k] = truth.hit ? "miss for a hit" : "hit for a miss";
      if (!hit.hit() || !truth.hit) continue;
      if (voxel != truth.voxel)
        out[k] = "wrong voxel";
      else if (!same_t(hit.t, truth.t))
        out[k] = "wrong t";
      else if (hit.face != truth.face)
        out[k] = "wrong face";
      else if (hit.label != truth.instance.cell)
        out[k] = "wrong cell";
    }
    return out;
  }
};

/// Ends in turn without limit, just behind the hit, and just before it.
struct AskAnyHits {
  static Answers differences(const Caster& caster, std::span<const Ray> rays, std::span<const Truth> truths) {
    Answers out(rays.size());
    std::vector<double> ends(rays.size(), std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const double margin = 1e-9 * (1 + std::abs(truths[k].t));
      if (k % 3 > 0) ends[k] = truths[k].t + (k % 3 == 1 ? margin : -margin);
    }
    std::vector<std::uint8_t> found(rays.size());
    caster.any_hits(rays, ends, found);
    for (std::size_t k = 0; k < rays.size(); ++k)
      if (bool(found[k]) != (truths[k].hit && k % 3 < 2))
        out[k] = found[k] ? "any hit for none" : "no hit for one";
    return out;
  }
};

/// What differs of a ray, by all ways to ask; empty if nothing.
template <typename... Ask>
std::vector<std::string> differences(const Caster& caster, std::span<const Ray> rays,
                                     std::span<const Truth> truths) {
  std::vector<std::string> out(rays.size());
  const auto add = [&](const Answers& answers) {
    for (std::size_t k = 0; k < out.size(); ++k)
      if (out[k].empty()) out[k] = answers[k];
  };
  (add(Ask::differences(caster, rays, truths)), ...);
  return out;
}

std::vector<std::string> all_differences(const Caster& caster, std::span<const Ray> rays,
                                         std::span<const Truth> truths) {
  return differences<AskFirstHit, AskFirstHits, AskAnyHits>(caster, rays, truths);
}

/// A ray whose coordinates are integers / 2^shift and integers; doubles hold them.
struct IntegerRay {
  std::array<std::int64_t, 3> origin{}, direction{};
  unsigned shift = 0;
};

std::int64_t voxels_along(const CellObject& object, std::size_t a) {
  return std::int64_t(object.grid.tiles[a]) * object.tile.resolution[a];
}

/// From -room to the other side of the grid + room, in units of the ray.
std::int64_t random_coordinate(Rng& rng, std::int64_t n, std::int64_t room, std::int64_t unit) {
  return std::int64_t(rng.bits(32) * std::uint64_t((n + 2 * room) * unit) >> 32) - room * unit;
}

IntegerRay random_ray(Rng& rng, const CellObject& object) {
  IntegerRay r;
  const std::uint32_t kind = rng.below(4);
  r.shift = kind < 2 ? rng.below(3) : 16;
  const std::int64_t unit = std::int64_t{1} << r.shift;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t n = voxels_along(object, a);
    // From well before the grid to well behind it; half of the rays begin within.
    r.origin[a] = random_coordinate(rng, n, rng.below(2) ? 0 : n, unit);
    switch (kind) {
      case 0:
        r.direction[a] = std::int64_t(rng.below(9)) - 4;
        break;
      case 1:
        r.direction[a] = std::int64_t(rng.below(2048)) - 1024;
        break;
      case 2:
        r.direction[a] = std::int64_t(rng.below(7)) - 3;
        break;
      default:
        r.direction[a] = (std::int64_t(rng.below(2048)) - 1024) * (rng.below(8) != 0);
        break;
    }
  }
  const std::size_t axis = rng.below(3);
  if (kind == 2) r.direction[axis] = rng.below(2) ? 1000 : -1000;
  if (r.direction == std::array<std::int64_t, 3>{}) r.direction[axis] = 1;
  if (rng.below(4) == 0)  // far away, aimed back at where it was
    for (std::size_t a = 0; a < 3; ++a) r.origin[a] -= 100 * unit * r.direction[a];
  return r;
}

/// Rays that a walk with rounding gets wrong.
IntegerRay adversarial_ray(Rng& rng, const CellObject& object) {
  IntegerRay r;
  const std::uint32_t kind = rng.below(8);
  std::array<std::int64_t, 3> n{};
  for (std::size_t a = 0; a < 3; ++a) {
    n[a] = voxels_along(object, a);
    r.origin[a] = random_coordinate(rng, n[a], rng.below(3) == 0 ? 3 : 0, 1);
  }
  const auto sign = [&] { return rng.below(2) ? 1 : -1; };
  const auto small = [&](std::int64_t most) {
    return std::int64_t(rng.below(std::uint32_t(2 * most + 1))) - most;
  };
  const std::size_t axis = rng.below(3), other = (axis + 1 + rng.below(2)) % 3, third = 3 - axis - other;
  switch (kind) {
    case 0:  // along an axis, on edges of voxels
      r.direction[axis] = sign();
      break;
    case 1:  // through edges and corners
      for (std::size_t a = 0; a < 3; ++a) r.direction[a] = small(1);
      break;
    case 2:  // on a plane between voxels
      r.shift = 8;
      for (std::size_t a = 0; a < 3; ++a) r.origin[a] *= 256;
      r.origin[other] += small(255);
      r.origin[third] += small(255);
      r.direction[other] = small(1000);
      r.direction[third] = small(1000);
      break;
    case 3:  // from inside, if that can be found
      for (int k = 0; k < 64; ++k) {
        for (std::size_t a = 0; a < 3; ++a) r.origin[a] = random_coordinate(rng, n[a], 0, 1);
        if (is_inside(object, {r.origin[0], r.origin[1], r.origin[2]})) break;
      }
      for (std::size_t a = 0; a < 3; ++a) r.direction[a] = small(2);
      break;
    case 4:  // grazing, a billionth off an axis and off the planes
      r.shift = 12;
      for (std::size_t a = 0; a < 3; ++a) r.origin[a] = r.origin[a] * 4096 + small(1);
      r.direction[axis] = 1000000000LL * sign();
      r.direction[other] = sign();
      r.direction[third] = small(1);
      break;
    case 5:  // a million tiles away, aimed at a corner
      for (std::size_t a = 0; a < 3; ++a) {
        r.direction[a] = small(3);
        r.origin[a] -= 11 * 1000000 * r.direction[a];
      }
      break;
    case 6:  // on the borders of the grid, in and out
      for (std::size_t a = 0; a < 3; ++a) {
        if (rng.below(3) != 0) r.origin[a] = rng.below(2) ? 0 : n[a];
        r.direction[a] = small(2);
      }
      break;
    default:  // from a corner of voxels
      for (std::size_t a = 0; a < 3; ++a) r.direction[a] = small(5);
      break;
  }
  if (r.direction == std::array<std::int64_t, 3>{}) r.direction[axis] = sign();
  return r;
}

Ray to_ray(const IntegerRay& r) {
  Ray ray;
  for (std::size_t a = 0; a < 3; ++a) {
    ray.origin[a] = std::ldexp(double(r.origin[a]), -int(r.shift));
    ray.direction[a] = double(r.direction[a]);
  }
  return ray;
}

Truth truth_of(const CellObject& object, const IntegerRay& r) {
  std::array<WideRational, 3> origin, direction, inverse;
  for (std::size_t a = 0; a < 3; ++a) {
    origin[a] = {r.origin[a], std::int64_t{1} << r.shift};
    direction[a] = {r.direction[a], 1};
    if (r.direction[a] != 0) inverse[a] = {1, r.direction[a]};
  }
  return truth_of(object, origin, direction, inverse);
}

/// Every tenth ray is adversarial.
void check_integer_rays(const std::string& recipe, const Index3& tiles, double share, std::uint64_t seed,
                        std::size_t rays) {
  Rng rng(seed);
  const CellObject object = random_object(rng, recipe, tiles, share);
  const auto caster = make_exact_caster(object);
  std::atomic<std::size_t> wrong{0}, hits{0}, adversarial_hits{0}, begun{0};
  std::mutex mutex;
  std::string first;
  parallel_for(rays / 1000, 0, [&](std::size_t chunk, unsigned) {
    Rng own(seed * 1000003 + chunk);
    std::vector<Ray> some(1000);
    std::vector<Truth> truths(some.size());
    for (std::size_t k = 0; k < some.size(); ++k) {
      const IntegerRay r = k % 10 == 0 ? adversarial_ray(own, object) : random_ray(own, object);
      some[k] = to_ray(r);
      truths[k] = truth_of(object, r);
      hits += truths[k].hit;
      adversarial_hits += truths[k].hit && k % 10 == 0;
      begun += truths[k].hit && truths[k].face < 0;
    }
    const auto found = all_differences(*caster, some, truths);
    for (std::size_t k = 0; k < some.size(); ++k) {
      if (found[k].empty()) continue;
      ++wrong;
      const std::lock_guard lock(mutex);
      if (first.empty())
        first = found[k] + " at ray " + std::to_string(k) + " of chunk " + std::to_string(chunk);
    }
  });
  INFO(recipe << ": " << first);
  CHECK(wrong == 0);
  CHECK(hits > rays / 20);
  CHECK(hits < rays);
  CHECK(adversarial_hits > rays / 200);
  CHECK(begun > rays / 1000);
}

/// `rays` in all, on tiles that are filled and not, whose edges differ, of one cell and of many.
void check_integer_rays(std::size_t rays) {
  check_integer_rays("voronoi:cells=4,resolution=8,seed=1", {3, 3, 3}, 0.1, 1, rays / 4);
  check_integer_rays("spheres:cells=3,resolution=11,seed=2", {2, 3, 1}, 0.6, 2, rays / 4);
  check_integer_rays("voronoi:cells=40,resolution=7x9x5,seed=3", {2, 2, 4}, 0.05, 3, rays / 4);
  check_integer_rays("voronoi:cells=1,resolution=6,seed=4", {4, 4, 4}, 0.4, 4, rays / 4);
}

/// Arbitrary doubles; every tenth ray is near a place where rounding decides.
Ray arbitrary_ray(Rng& rng, bool adversarial) {
  Ray ray;
  const double reach = std::ldexp(1.0, int(rng.below(24)));  // up to a million tiles away
  const double slope = std::ldexp(1.0, -int(rng.below(60)));
  for (std::size_t a = 0; a < 3; ++a) {
    ray.direction[a] = rng.uniform(-1, 1) * (rng.below(3) == 0 ? slope : 1);
    // A lattice point, or a point anywhere, then back along the ray: rounding leaves it just beside.
    const double target = rng.below(2) ? rng.below(24) : rng.uniform(0, 24);
    ray.origin[a] = target - ray.direction[a] * reach;
  }
  if (!adversarial) return ray;
  const std::size_t axis = rng.below(3);
  switch (rng.below(4)) {
    case 0:  // along an axis, a last bit off or none
      for (std::size_t a = 0; a < 3; ++a) {
        ray.origin[a] = std::nextafter(double(rng.below(25)), rng.below(2) ? -100.0 : 100.0);
        ray.direction[a] = a == axis ? 1 : rng.below(2) ? 0 : std::ldexp(rng.uniform(-1, 1), -52);
      }
      break;
    case 1:  // a diagonal, a last bit off
      for (std::size_t a = 0; a < 3; ++a) {
        ray.origin[a] = double(rng.below(25)) + (rng.below(2) ? 0x1p-48 : 0);
        ray.direction[a] = rng.below(2) ? std::nextafter(1, 2) : -std::nextafter(1, 0);
      }
      break;
    case 2:  // grazing a border of the grid
      ray.origin[axis] = rng.below(2) ? 0 : 24;
      ray.direction[axis] = rng.uniform(-1e-9, 1e-9);
      break;
    default:  // begins within, at a corner or at its last bit
      for (std::size_t a = 0; a < 3; ++a) {
        ray.origin[a] = double(1 + rng.below(23));
        if (rng.below(2)) ray.origin[a] = std::nextafter(ray.origin[a], 0);
      }
      break;
  }
  return ray;
}

/// Checks `rays` rays against rational arithmetic.
void check_arbitrary_rays(std::size_t rays) {
  Rng rng(5);
  const CellObject object = random_object(rng, "voronoi:cells=5,resolution=8,seed=6", {3, 2, 3}, 0.2);
  const auto caster = make_exact_caster(object);
  std::vector<Ray> all(rays);
  for (std::size_t k = 0; k < rays; ++k) all[k] = arbitrary_ray(rng, k % 10 == 0);
  std::vector<Truth> truths(rays);
  parallel_for(rays, 0, [&](std::size_t k, unsigned) {
    std::array<BigRational, 3> origin, direction, inverse;
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = BigRational(mpq_class(all[k].origin[a]));
      direction[a] = BigRational(mpq_class(all[k].direction[a]));
      if (all[k].direction[a] != 0) inverse[a] = BigRational(mpq_class(1 / mpq_class(all[k].direction[a])));
    }
    truths[k] = truth_of(object, origin, direction, inverse);
  });
  const auto found = all_differences(*caster, all, truths);
  std::size_t hits = 0;
  for (std::size_t k = 0; k < rays; ++k) {
    INFO(found[k] << " at ray " << k);
    REQUIRE(found[k].empty());
    hits += truths[k].hit;
  }
  CHECK(hits > rays / 10);
}

}  // namespace

TEST_CASE("exact tracing equals the definition on a million rays of integers") {
  check_integer_rays(repetitions(1000000));
}

TEST_CASE("exact tracing equals the definition on ten million rays of integers", "[slow]") {
  check_integer_rays(10000000);
}

TEST_CASE("exact tracing equals the definition on rays of arbitrary doubles") {
  check_arbitrary_rays(repetitions(10000));
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
