#include "sdk/author/height_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/membership/diagnose.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

HeightField random_field(Rng& rng, std::uint32_t width, std::uint32_t depth, double missing) {
  HeightField field{.width = width, .depth = depth, .spacing = 0.1 + rng.uniform()};
  for (std::uint32_t i = 0; i < width * depth; ++i)
    field.samples.push_back(rng.uniform() < missing ? kMissing : float(rng.uniform(100, 900)));
  field.samples[0] = 500;
  field.scale = rng.uniform() < 0.5 ? 0.01 : -0.01;
  field.zero = 400;
  field.floor = -6;
  return field;
}

/// The height at a place as its definition has it, found anew from all samples.
double slow_height(const HeightField& field, double x, double z) {
  double sum = 0, weights = 0;
  float nearest = kMissing;
  double best = 1e300;
  const auto distance = [&](double at, std::uint32_t k, std::uint32_t count) {
    const double u = std::clamp(at / field.spacing - 0.5, 0.0, double(count - 1));
    return std::abs(u - k);
  };
  for (std::uint32_t j = 0; j < field.depth; ++j)
    for (std::uint32_t i = 0; i < field.width; ++i) {
      const double a = distance(x, i, field.width), b = distance(z, j, field.depth);
      if (std::max(a, b) < best && a <= 0.5 && b <= 0.5) {
        best = std::max(a, b);
        nearest = field.samples[i + field.width * j];
      }
    }
  if (std::isnan(nearest)) return std::numeric_limits<double>::quiet_NaN();
  for (std::uint32_t j = 0; j < field.depth; ++j)
    for (std::uint32_t i = 0; i < field.width; ++i) {
      const double a = distance(x, i, field.width), b = distance(z, j, field.depth);
      if (a >= 1 || b >= 1) continue;
      const float s = field.samples[i + field.width * j];
      sum += (1 - a) * (1 - b) * field.height(std::isnan(s) ? nearest : s);
      weights += (1 - a) * (1 - b);
    }
  return sum / weights;
}

}  // namespace

TEST_CASE("heights between samples are bilinear, and stay beyond the last") {
  Rng rng(11);
  for (int round = 0; round < 20; ++round) {
    const HeightField field = random_field(rng, 1 + rng.below(9), 1 + rng.below(9), round % 3 == 0 ? 0.3 : 0);
    const HeightBlock block(field);
    for (int k = 0; k < 200; ++k) {
      const double x = rng.uniform() * field.width * field.spacing,
                   z = rng.uniform() * field.depth * field.spacing;
      const double expected = slow_height(field, x, z), found = block.height_at(x, z);
      CHECK(std::isnan(expected) == std::isnan(found));
      if (!std::isnan(expected)) CHECK(found == Approx(expected).epsilon(1e-12).margin(1e-12));
      const double y = rng.uniform(-7, 6);
      CHECK(block.inside({x, y, z}) == (y >= field.floor && y < found));
    }
    CHECK_FALSE(block.inside({-1e-9, -5.9, 0.1}));
    CHECK_FALSE(block.inside({field.width * field.spacing, -5.9, 0.1}));
  }
}

TEST_CASE("what a block says of a box holds for every point of it") {
  Rng rng(12);
  std::uint64_t decided = 0, boxes = 0;
  for (int round = 0; round < 40; ++round) {
    const HeightField field =
        random_field(rng, 1 + rng.below(40), 1 + rng.below(40), round % 4 == 0 ? 0.05 : 0);
    const HeightBlock block(field);
    const Box3 all = block.box();
    for (int k = 0; k < 200; ++k, ++boxes) {
      Box3 box;
      Vec3 corner, extent;
      for (std::size_t a = 0; a < 3; ++a) {
        corner[a] = all.min[a] - 0.2 + rng.uniform() * (all.max[a] - all.min[a] + 0.4);
        extent[a] = rng.uniform() * (k % 2 ? 0.2 : 2.0);
      }
      box.add(corner);
      box.add(corner + extent);
      const BoxSide side = block.side(box);
      if (side == BoxSide::kMixed) continue;
      ++decided;
      for (int i = 0; i < 50; ++i) {
        Vec3 p;
        for (std::size_t a = 0; a < 3; ++a)
          p[a] = i < 8 ? (i >> a & 1 ? box.max[a] : box.min[a]) : corner[a] + rng.uniform() * extent[a];
        if (block.inside(p) != (side == BoxSide::kInside)) FAIL("a point of the box is on the other side");
      }
    }
  }
  CHECK(decided > boxes / 8);  // else it says nothing
}

TEST_CASE("a mesh of heights is closed, outward, and as large as its squares") {
  Rng rng(13);
  for (const double missing : {0.0, 0.1, 0.4}) {
    HeightField field = random_field(rng, 23, 17, missing);
    field.floor = -10;
    const auto mesh = make_height_mesh(field);
    REQUIRE(mesh);
    CHECK(diagnose(*mesh).closed());
    double volume = 0;
    for (std::uint32_t j = 0; j + 1 < field.depth; ++j)
      for (std::uint32_t i = 0; i + 1 < field.width; ++i) {
        const auto s = [&](std::uint32_t a, std::uint32_t b) {
          return field.height(field.samples[i + a + field.width * (j + b)]) - field.floor;
        };
        // Two triangles: those at the diagonal from (0, 0) to (1, 1) count twice.
        const double square =
            (2 * s(0, 0) + s(0, 1) + s(1, 0) + 2 * s(1, 1)) / 6 * field.spacing * field.spacing;
        if (!std::isnan(square)) volume += square;
      }
    CHECK(signed_volume(*mesh) == Approx(volume).epsilon(1e-10));
  }
  HeightField sunk = random_field(rng, 5, 5, 0);
  sunk.floor = 0;
  sunk.samples[7] = float(sunk.zero);
  CHECK(make_height_mesh(sunk).error().code == ErrorCode::kInvalidInput);
}

TEST_CASE("a block fills with cells as a fine mesh of it does") {
  Rng rng(14);
  HeightField field = random_field(rng, 12, 12, 0);
  field.scale = 0.002;
  field.zero = 100;
  field.floor = -0.5;
  const auto tile = make_tile(*parse_recipe("voronoi:cells=8,resolution=16,seed=1"));
  AuthorOptions options;
  options.grid.tiles = 12;
  const auto block = author_cell_object(HeightBlock(field), *tile, options);
  REQUIRE(block);
  // The volume inside cannot exceed the block's, and most of it is filled.
  double volume = 0;
  const HeightBlock shape(field);
  for (int k = 0; k < 100000; ++k)
    volume += shape.height_at(rng.uniform() * 12 * field.spacing, rng.uniform() * 12 * field.spacing) + 0.5;
  volume *= 144 * field.spacing * field.spacing / 100000;
  CHECK(inside_volume(*block) < volume);
  CHECK(inside_volume(*block) > 0.4 * volume);
}

TEST_CASE("fields that are none are refused") {
  HeightField field{.width = 2, .depth = 2, .samples = {1, 2, 3, 4}, .spacing = 1};
  CHECK(check_height_field(field));
  const auto refused = [&](auto change) {
    HeightField other = field;
    change(other);
    return !check_height_field(other);
  };
  CHECK(refused([](HeightField& f) { f.samples.pop_back(); }));
  CHECK(refused([](HeightField& f) { f.samples.assign(4, kMissing); }));
  CHECK(refused([](HeightField& f) { f.samples[2] = std::numeric_limits<float>::infinity(); }));
  CHECK(refused([](HeightField& f) { f.spacing = 0; }));
  CHECK(refused([](HeightField& f) { f.spacing = std::nan(""); }));
  CHECK(refused([](HeightField& f) {
    f.scale = 1e308;
    f.zero = -1e10;
  }));
  CHECK(refused([](HeightField& f) { f.floor = std::numeric_limits<double>::infinity(); }));
}

TEST_CASE("a layer of bricks becomes a cell for each above the mortar, around the border too") {
  // Bricks of 6 × 4 samples in running bond, mortar of 2 between them; 16 × 12 samples in all.
  HeightField field{.width = 16, .depth = 12, .spacing = 1};
  for (std::uint32_t j = 0; j < 12; ++j)
    for (std::uint32_t i = 0; i < 16; ++i) {
      const std::uint32_t shift = j / 6 % 2 * 4;
      field.samples.push_back((i + shift) % 8 < 6 && j % 6 < 4 ? 0.9f : 0.1f);
    }
  HeightTileOptions options{.resolution = {16, 8, 12}, .gap = 0.5};
  const auto labels = height_labels(field, options);
  REQUIRE(labels);
  const auto tile = make_label_tile(*labels, Percolating::kRefuse);
  REQUIRE(tile);
  CHECK(tile->cell_count == 4);
  // 8 / 1.25 voxels high, 6 × 4 columns each.
  CHECK(std::ranges::count(labels->labels, 1u) == 4 * 6 * 4 * 6);
  field.scale = -1;  // black is up: now the mortar is a cell, which has no end
  CHECK(make_label_tile(*height_labels(field, options), Percolating::kRefuse).error().id ==
        "tile-percolates");
  const auto fewer = height_labels(field, {.resolution = {4, 4, 4}});
  CHECK(fewer);
  field.samples.assign(field.samples.size(), 1);
  CHECK(height_labels(field, options).error().code == ErrorCode::kInvalidInput);
}
