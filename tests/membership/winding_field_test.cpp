#include "sdk/membership/winding_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/membership/box_distance.h"
#include "sdk/membership/cap_gradient.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

Vec3 place(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// Triangles of sizes from 0.01 to the whole, slivers among them, here and there.
std::vector<std::array<Vec3, 3>> triangles(Rng& rng, std::size_t count) {
  std::vector<std::array<Vec3, 3>> all;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 at = place(rng, 20);
    const double size = std::pow(10.0, rng.uniform(-2, 1.3));
    std::array<Vec3, 3> t{at, at + place(rng, size), at + place(rng, size)};
    if (rng.below(4) == 0) t[2] = t[0] + (t[1] - t[0]) * rng.uniform() + place(rng, 1e-4 * size);
    all.push_back(t);
  }
  return all;
}

Vec3 within(Rng& rng, const Box3& box) {
  const Vec3 e = box.extent();
  return box.min + Vec3{e.x * rng.uniform(), e.y * rng.uniform(), e.z * rng.uniform()};
}

/// A cap of a random closed polygon, as a fan.
CapGradient::Cap random_cap(Rng& rng) {
  const Vec3 at = place(rng, 15);
  const double size = std::pow(10.0, rng.uniform(-1, 1));
  std::vector<Vec3> loop;
  for (std::uint32_t k = 0, n = 3 + rng.below(6); k < n; ++k) loop.push_back(at + place(rng, size));
  CapGradient::Cap cap;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    cap.loop.push_back({loop[k], loop[(k + 1) % loop.size()]});
    if (k >= 2) cap.triangles.push_back({loop[0], loop[k - 1], loop[k]});
  }
  return cap;
}

}  // namespace

TEST_CASE("a winding number by moments is off by no more than it says, nor by much less at best") {
  Rng rng(31);
  double worst = 0;
  for (int round = 0; round < 40; ++round) {
    const WindingField field(triangles(rng, 1 + rng.below(200)));
    for (int k = 0; k < 50; ++k) {
      const Vec3 p = place(rng, round % 2 ? 25 : 80);
      const WindingField::Value exact = field.sum(p);
      double last = 1e9;
      for (const double tolerance : {1.0, 1e-2, 1e-4, 1e-7}) {
        const WindingField::Value value = field.approximate(p, tolerance);
        CHECK(std::abs(value.winding - exact.winding) <= value.error + exact.error);
        CHECK(value.error <= last * 1.0001 + 1e-11);
        last = value.error;
        if (value.error > 1e-9)
          worst = std::max(worst, std::abs(value.winding - exact.winding) / value.error);
      }
    }
  }
  CHECK(worst > 0.05);
}

TEST_CASE("a winding number from its box's centre is off by no more than it says") {
  Rng rng(32);
  WindingField::Local local;
  for (int round = 0; round < 60; ++round) {
    const WindingField field(triangles(rng, 1 + rng.below(150)));
    const Vec3 low = place(rng, 20);
    const Box3 box{low, low + Vec3{1, 1, 1} * std::pow(10.0, rng.uniform(-1, 0.7))};
    for (const double tolerance : {0.1, 1e-2, 1e-3}) {
      field.localize(box, tolerance, local);
      for (int k = 0; k < 20; ++k) {
        const Vec3 p = within(rng, box);
        const WindingField::Value exact = field.sum(p), value = field.at(local, p);
        CHECK(std::abs(value.winding - exact.winding) <= value.error + exact.error);
      }
    }
  }
}

TEST_CASE("what bounds a field in a box does, at every point of it") {
  Rng rng(33);
  int clear = 0;
  for (int round = 0; round < 300; ++round) {
    const std::vector<std::array<Vec3, 3>> all = triangles(rng, 1 + rng.below(40));
    const WindingField field(all);
    const Vec3 low = place(rng, 15);
    const Box3 box{low, low + Vec3{1, 1, 1} * std::pow(10.0, rng.uniform(-1, 1))};
    const double bound = field.bound(box, 1e9);
    for (int k = 0; k < 30; ++k) {
      const Vec3 p = within(rng, box);
      CHECK(std::abs(field.sum(p).winding) <= bound + 1e-12);
      for (const std::array<Vec3, 3>& t : all) {
        const double a = rng.uniform(), b = rng.uniform() * (1 - a);
        const Vec3 q = t[0] + (t[1] - t[0]) * a + (t[2] - t[0]) * b;
        CHECK(distance_bound(t, box) <= length(q - p));
        if (field.clear_of(box))
          CHECK(!(q.x > box.min.x && q.x < box.max.x && q.y > box.min.y && q.y < box.max.y &&
                  q.z > box.min.z && q.z < box.max.z));
      }
    }
    clear += field.clear_of(box);
  }
  CHECK(clear > 50);
  CHECK(clear < 295);
}

TEST_CASE("caps' winding number is nowhere steeper than its bound, and a bound is not worthless") {
  Rng rng(34);
  int finite = 0;
  double tightest = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<CapGradient::Cap> caps;
    std::vector<std::array<Vec3, 3>> all;
    for (std::uint32_t k = 0, n = 1 + rng.below(20); k < n; ++k) {
      caps.push_back(random_cap(rng));
      all.insert(all.end(), caps.back().triangles.begin(), caps.back().triangles.end());
    }
    const WindingField field(all);
    const CapGradient gradient(caps);
    const Vec3 low = place(rng, 20);
    const Box3 box{low, low + Vec3{1, 1, 1} * std::pow(10.0, rng.uniform(-1, 1))};
    const double bound = gradient.bound(box);
    if (!field.clear_of(box) || !(bound < 1e9)) continue;
    ++finite;
    for (int k = 0; k < 20; ++k) {
      const Vec3 p = within(rng, box);
      constexpr double h = 1e-5;
      const auto slope = [&](Vec3 d) {
        return (field.sum(p + d * h).winding - field.sum(p - d * h).winding) / (2 * h);
      };
      const double steep = length(Vec3{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})});
      CHECK(steep <= bound * 1.001 + 1e-8);
      tightest = std::max(tightest, steep / bound);
    }
  }
  CHECK(finite > 100);
  CHECK(tightest > 0.2);
}
