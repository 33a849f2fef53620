#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/shade/clip.h"
#include "sdk/trace/cell_object_caster.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/scene.h"
#include "sdk/trace/walk.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

struct Stretch {
  Hit in, out;
};

std::vector<Stretch> stretches_of(const Caster& caster, const Ray& ray) {
  std::vector<Stretch> out;
  caster.all_hits(ray, [&](const Hit& in, const Hit& leaves) {
    out.push_back({in, leaves});
    return true;
  });
  return out;
}

Vec3 normal_of(const WalkRay& walk, int axis, bool outward) {
  Vec3 n;
  if (axis >= 0) n[std::size_t(axis)] = walk.rises(std::size_t(axis)) == outward ? 1 : -1;
  return n;
}

/// One voxel after the other. The corner is at the origin, voxels are of one metre.
std::vector<Stretch> stretches_by_voxels(const CellObject& object, const Ray& ray) {
  std::vector<Stretch> out;
  Voxel size{};
  for (std::size_t a = 0; a < 3; ++a)
    size[a] = std::int64_t{object.grid.tiles[a]} * object.tile.resolution[a];
  WalkRay walk;
  WalkPlace place;
  if (!WalkRay::make(ray, walk) || !enter_grid(walk, size, place)) return out;
  bool within = false;
  for (;;) {
    for (std::size_t a = 0; a < 3; ++a)
      if (place.voxel[a] < 0 || place.voxel[a] >= size[a]) return out;
    const Voxel v = place.voxel;
    const double t = place.t * walk.scale;
    const auto instance = instance_at(object, v);
    leave_box(walk, v, {v[0] + 1, v[1] + 1, v[2] + 1}, place);
    const bool before = within;
    within = instance.has_value();
    if (!within) continue;
    Hit hit;
    hit.label = instance->cell;
    hit.instance = instance->home;
    hit.element = v;
    if (!before) {
      hit.t = t;
      hit.face_normal = normal_of(walk, entry_axis(walk, v), false);
      out.push_back({hit, {}});
    }
    hit.t = place.t * walk.scale;
    hit.face_normal = normal_of(walk, place.entry_axis, true);
    out.back().out = hit;
  }
}

bool same(const Hit& a, const Hit& b) {
  return a.label == b.label && a.instance == b.instance && a.element == b.element &&
         a.face_normal == b.face_normal && std::abs(a.t - b.t) <= 1e-12 * (1 + std::abs(b.t));
}

std::string difference(const std::vector<Stretch>& found, const std::vector<Stretch>& truth) {
  if (found.size() != truth.size())
    return std::to_string(found.size()) + " stretches for " + std::to_string(truth.size());
  for (std::size_t k = 0; k < found.size(); ++k)
    for (const bool end : {false, true})
      if (!same(end ? found[k].out : found[k].in, end ? truth[k].out : truth[k].in))
        return (end ? "wrong end of stretch " : "wrong begin of stretch ") + std::to_string(k);
  return {};
}

/// Anywhere, or where a walk with rounding goes wrong.
Ray make_ray(Rng& rng, const CellObject& object) {
  Ray ray;
  const std::uint32_t kind = rng.below(6);
  const std::size_t axis = rng.below(3);
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t n = std::int64_t{object.grid.tiles[a]} * object.tile.resolution[a];
    const double whole = double(rng.below(std::uint32_t(n + 1)));
    ray.origin[a] = kind == 0 ? rng.uniform(-double(n), 2 * double(n)) : whole;
    switch (kind) {
      case 0:  // anywhere
        ray.direction[a] = rng.uniform(-1, 1);
        break;
      case 1:  // along an axis, on edges of voxels or within them
        ray.origin[a] += rng.below(2) * 0.5;
        ray.direction[a] = a == axis ? (rng.below(2) ? 2 : -2) : 0;
        break;
      case 2:  // through edges and corners
        ray.direction[a] = double(rng.below(3)) - 1;
        break;
      case 3:  // through corners, at slopes that meet few of them
        ray.direction[a] = double(rng.below(11)) - 5;
        break;
      case 4:  // from the grid's border
        if (a == axis) ray.origin[a] = rng.below(2) ? 0 : double(n);
        ray.direction[a] = rng.below(4) ? rng.uniform(-1, 1) : 0;
        break;
      default:  // grazing planes
        ray.origin[a] = std::nextafter(whole, rng.below(2) ? -1 : 100);
        ray.direction[a] = a == axis ? 1 : rng.uniform(-1, 1) * 0x1p-40;
        break;
    }
  }
  if (ray.direction == Vec3{}) ray.direction[axis] = -1;
  // From before the grid, aimed at the same places.
  if (rng.below(2)) ray.origin = ray.origin - ray.direction * 64;
  return ray;
}

const char* const kRecipes[] = {"voronoi:cells=30,resolution=8,seed=1",
                                "spheres:cells=9,resolution=16,seed=2",
                                "voronoi:cells=20,resolution=7x9x5,seed=3"};

}  // namespace

TEST_CASE("stretches of exact tracing are those of a walk from voxel to voxel") {
  std::size_t stretches = 0, begun = 0, thin = 0;
  for (const char* recipe : kRecipes) {
    Rng rng(1);
    const CellObject object = random_object(rng, recipe, {3, 2, 3}, 0.5);
    const auto caster = make_exact_caster(object);
    for (int k = 0; k < 30000; ++k) {
      const Ray ray = make_ray(rng, object);
      const std::vector<Stretch> found = stretches_of(*caster, ray);
      INFO(recipe << ", ray " << k);
      REQUIRE(difference(found, stretches_by_voxels(object, ray)) == "");
      Hit first, exit;
      REQUIRE(caster->first_hit(ray, first) == !found.empty());
      if (found.empty()) continue;
      REQUIRE((first.t == found[0].in.t && same(first, found[0].in)));
      const bool begins = found[0].in.face_normal == Vec3{};
      REQUIRE(caster->first_exit(ray, exit) == begins);
      if (begins) REQUIRE((exit.t == found[0].out.t && same(exit, found[0].out)));
      stretches += found.size();
      begun += begins;
      for (std::size_t s = 1; s < found.size(); ++s) thin += found[s].in.t - found[s - 1].out.t < 1e-9;
    }
  }
  CHECK(stretches > 50000);
  CHECK(begun > 5000);
  // Gaps of edges, which rays begun behind would not see.
  CHECK(thin > 100);
}

TEST_CASE("stretches end when the visitor says so, and of no ray there are any") {
  Rng rng(2);
  const CellObject object = random_object(rng, kRecipes[0], {3, 3, 3}, 0.3);
  const auto caster = make_exact_caster(object);
  Ray ray;
  while (stretches_of(*caster, ray).size() < 5)
    ray = {{rng.uniform(0, 24), rng.uniform(0, 24), -1}, {rng.uniform(-1, 1), rng.uniform(-1, 1), 1}};
  for (const char* method : {"exact", "linear:1/64"}) {
    const auto any = make_cell_object_caster(object, method);
    REQUIRE(any.ok());
    const std::size_t count = stretches_of(**any, ray).size();
    REQUIRE(count > 2);
    for (std::size_t most = 1; most <= count; ++most) {
      std::size_t calls = 0;
      (*any)->all_hits(ray, [&](const Hit&, const Hit&) { return ++calls < most; });
      CHECK(calls == most);
    }
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    for (const Ray& none : {Ray{{9, 9, 9}, {}}, Ray{{9, 9, 9}, {nan, 1, 1}}, Ray{{9, nan, 9}, {1, 1, 1}},
                            Ray{{9, 9, inf}, {0, 0, -1}}, Ray{{9, 9, 9}, {0, inf, 0}}})
      CHECK(stretches_of(**any, none).empty());
  }
}

TEST_CASE("stretches by rays begun behind equal the exact ones but for thin ones") {
  Rng rng(3);
  const CellObject object = random_object(rng, kRecipes[0], {5, 4, 5}, 0.9);
  const auto caster = make_exact_caster(object);
  std::size_t stretches = 0, begun = 0, other = 0;
  for (int k = 0; k < 10000; ++k) {
    Ray ray;
    for (std::size_t a = 0; a < 3; ++a) {
      ray.origin[a] = rng.uniform(-10, 50);
      ray.direction[a] = rng.uniform(-1, 1);
    }
    const double speed = length(ray.direction);
    std::vector<Stretch> truth;  // without stretches and gaps of 1/256 voxel
    for (const Stretch& s : stretches_of(*caster, ray)) {
      const double least = 1.0 / 256 / speed;
      if (s.out.t - s.in.t < least) continue;
      if (!truth.empty() && s.in.t - truth.back().out.t < least)
        truth.back().out = s.out;
      else
        truth.push_back(s);
    }
    std::vector<Stretch> found;
    caster->Caster::all_hits(ray, [&](const Hit& in, const Hit& out) {
      if (out.t - in.t >= 1.0 / 256 / speed) found.push_back({in, out});
      return true;
    });
    // What is about as thin as the share may be told either way.
    if (found.size() != truth.size()) {
      ++other;
      continue;
    }
    for (std::size_t s = 0; s < found.size(); ++s) {
      REQUIRE(found[s].in.t == Approx(truth[s].in.t).margin(1e-9));
      REQUIRE(found[s].out.t == Approx(truth[s].out.t).margin(1e-9));
      REQUIRE(found[s].in.element == truth[s].in.element);
      REQUIRE(found[s].out.element == truth[s].out.element);
      REQUIRE(found[s].out.face_normal == truth[s].out.face_normal);
      ++stretches;
      begun += found[s].in.face_normal == Vec3{};
    }
  }
  CHECK(stretches > 3000);
  CHECK(begun > 100);
  CHECK(other < 50);
}

TEST_CASE("an instance that a file says is INSIDE, though it leaves the grid, ends with the grid") {
  Rng rng(4);
  CellObject object = random_object(rng, kRecipes[2], {2, 2, 2}, 1);
  for (std::uint32_t& entry : object.membership.entries) entry = std::uint32_t(Tag::kInside);
  const auto caster = make_exact_caster(object);
  std::size_t borders = 0;
  for (int k = 0; k < 20000; ++k) {
    const Ray ray = make_ray(rng, object);
    const std::vector<Stretch> truth = stretches_by_voxels(object, ray);
    INFO(k);
    REQUIRE(difference(stretches_of(*caster, ray), truth) == "");
    borders += !truth.empty();
  }
  CHECK(borders > 5000);
}

TEST_CASE("any hit is up to the end, the end included") {
  Rng rng(5);
  const CellObject object = random_object(rng, kRecipes[0], {3, 3, 3}, 0.3);
  const double inf = std::numeric_limits<double>::infinity();
  for (const char* method : {"exact", "linear:1/64", "distance"}) {
    const auto caster = make_cell_object_caster(object, method);
    REQUIRE(caster.ok());
    std::vector<Ray> rays;
    std::vector<double> ends;
    std::vector<std::uint8_t> truth;
    for (int k = 0; k < 3000; ++k) {
      const Ray ray = make_ray(rng, object);
      Hit hit;
      const bool found = (*caster)->first_hit(ray, hit);
      const auto add = [&](double end, bool expected) {
        rays.push_back(ray);
        ends.push_back(end);
        truth.push_back(expected);
      };
      add(inf, found);
      add(std::nan(""), false);
      add(-1, false);
      if (!found) continue;
      add(hit.t, true);
      add(std::nextafter(hit.t, inf), true);
      add(std::nextafter(hit.t, -inf), false);
    }
    rays.push_back({{1, 1, 1}, {std::nan(""), 0, 0}});
    ends.push_back(inf);
    truth.push_back(false);
    std::vector<std::uint8_t> found(rays.size(), 7);
    (*caster)->any_hits(rays, ends, found);
    CHECK(found == truth);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      INFO(method << ", ray " << k);
      REQUIRE((*caster)->any_hit(rays[k], ends[k]) == bool(truth[k]));
    }
  }
}

TEST_CASE("assets of a scene that overlap or touch are one stretch, and a cut ends one") {
  const CellObject block = make_blocks({4, 4, 4}, 4, [](std::uint32_t x, auto...) { return x != 2; });
  const auto caster = make_exact_caster(block);
  // Solid is [0, 8) and [12, 16) of it along x; the second stands 14 further.
  const auto scene = make_scene({{caster.get(), Transform{}},
                                 {caster.get(), translation({14, 0, 0})},
                                 {caster.get(), translation({-8, 0, 0})}});
  REQUIRE(scene.ok());
  const Ray ray{{-20, 5.3, 5.1}, {2, 0, 0}};
  const std::vector<Stretch> found = stretches_of(**scene, ray);
  const auto at = [](const Hit& hit) { return -20 + 2 * hit.t; };
  REQUIRE(found.size() == 3);
  const double ends[] = {-8, 8, 12, 22, 26, 30};
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(at(found[k].in) == Approx(ends[2 * k]));
    CHECK(at(found[k].out) == Approx(ends[2 * k + 1]));
    CHECK(found[k].in.face_normal == Vec3{-1, 0, 0});
    CHECK(found[k].out.face_normal == Vec3{1, 0, 0});
  }
  CHECK(found[1].in.placement == 0);
  CHECK(found[1].out.placement == 1);
  const ClippedCaster clipped(**scene, {1, 0, 0}, 13);
  const std::vector<Stretch> kept = stretches_of(clipped, ray);
  REQUIRE(kept.size() == 2);
  CHECK(at(kept[1].out) == Approx(13));
  CHECK(kept[1].out.on_cut);
}
