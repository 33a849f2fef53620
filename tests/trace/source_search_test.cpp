// Where the source's search along rays goes wrong, and ours does not. [Nürnberg 2011, 3.2, 4.4]
#include <cmath>
#include <optional>
#include <vector>

#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/shade/radiance.h"
#include "sdk/tiles/labels.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/linear.h"
#include "tests/support/cast_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// What a sample of the source's search sees: the tag of the cell, or nothing in empty space and beyond the
/// grid.
std::optional<Tag> tag_at(const CellObject& o, const Vec3& p) {
  const Vec3 v = (p - to_vec3(o.grid.box_min)) / o.grid.voxel_edge;
  std::array<std::uint32_t, 3> tile{}, at{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(v[a] >= 0 && v[a] < double(o.grid.tiles[a]) * o.tile.resolution[a])) return std::nullopt;
    tile[a] = std::uint32_t(v[a]) / o.tile.resolution[a];
    at[a] = std::uint32_t(v[a]) % o.tile.resolution[a];
  }
  const std::uint32_t id = o.tile.id(o.tile.voxel_index(at[0], at[1], at[2]));
  if (id == 0) return std::nullopt;
  const Piece& p0 = o.tile.pieces[id - 1];
  std::array<std::uint32_t, 3> home{};
  for (std::size_t a = 0; a < 3; ++a) {
    home[a] = tile[a] + std::uint32_t(std::int32_t{p0.home[a]});
    if (home[a] >= o.grid.tiles[a]) return Tag::kIntersected;  // it leaves the grid
  }
  return o.membership.tag(o.grid.tile_index(home[0], home[1], home[2]), p0.cell);
}

/// A tile of boxes [low, high) of voxels, each a cell; all instances of the one tile are INSIDE.
CellObject solid_boxes(const Index3& n, const std::vector<std::array<Index3, 2>>& boxes) {
  LabelVolume volume{n, std::vector<std::uint32_t>(n[0] * n[1] * n[2], 0)};
  std::uint32_t label = 0;
  for (const auto& [low, high] : boxes) {
    ++label;
    for (std::uint32_t z = low[2]; z < high[2]; ++z)
      for (std::uint32_t y = low[1]; y < high[1]; ++y)
        for (std::uint32_t x = low[0]; x < high[0]; ++x) volume.labels[x + n[0] * (y + n[1] * z)] = label;
  }
  CellObject o;
  o.tile = *make_label_tile(volume, Percolating::kRefuse);
  o.grid = {{0, 0, 0}, 1, {1, 1, 1}};
  o.membership = {MembershipRule::kCentre, {1, 1, 1}, label, {std::uint32_t(Tag::kInside)}, {}};
  return o;
}

}  // namespace

TEST_CASE(
    "source 3.2.1: the search ends where a ray enters in empty space or in an outside cell; ours goes on") {
  // Seen from above, a ray enters the basic mesh, a tetrahedron, through its face x + y + z = 4.
  const TriangleMesh mesh = make_tetrahedron({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4});
  int ended_in_empty = 0, ended_in_outside = 0, passed_by = 0, hits = 0;
  for (const char* recipe :
       {"spheres:cells=8,resolution=16,seed=1", "voronoi:cells=8,resolution=16,seed=1"}) {
    const Result<CellObject> object = author_cell_object(mesh, *make_tile(*parse_recipe(recipe)), {});
    REQUIRE(object.ok());
    const auto caster = make_exact_caster(*object);
    for (int k = 0; k < 3600; ++k) {
      const double x = 0.02 + 3.5 * (k % 60) / 60, y = 0.02 + 3.5 * double(k / 60) / 60;
      if (x + y > 3.5) continue;
      const Vec3 entry{x, y, 4 - x - y - 1e-6};
      // Algorithm 3.1, rows 6 to 13, with steps that are as good as none.
      const double step = object->grid.voxel_edge / 16;
      std::optional<Tag> tag = tag_at(*object, entry);
      const std::optional<Tag> entry_tag = tag;
      for (double z = entry.z; tag == Tag::kIntersected; z -= step)
        tag = tag_at(*object, {entry.x, entry.y, z});
      // The truth, by the column of voxels.
      std::optional<double> top;
      for (double z = entry.z + 2 * object->grid.voxel_edge; z > 0 && !top; z -= step)
        if (tag_at(*object, {entry.x, entry.y, z}) == Tag::kInside) top = z;
      Hit hit;
      const bool found = caster->first_hit({{entry.x, entry.y, 5}, {0, 0, -1}}, hit);
      REQUIRE(found == top.has_value());
      if (!found) continue;
      ++hits;
      CHECK(std::abs(5 - hit.t - *top) <= step * (1 + 1e-6));
      if (tag == Tag::kInside) continue;
      (!entry_tag                        ? ended_in_empty
       : *entry_tag == Tag::kIntersected ? passed_by  // and came to empty space, or to an outside cell, later
                                         : ended_in_outside) += 1;
    }
  }
  INFO(hits << " hits; ended in empty space " << ended_in_empty << ", in outside cells " << ended_in_outside
            << ", after intersected ones " << passed_by);
  CHECK(hits > 3000);
  CHECK(ended_in_empty > 500);
  CHECK(ended_in_outside > 5);
  CHECK(passed_by > 300);
}

TEST_CASE("source 3.2.2: a step passes by thin cells, and bisection finds a boundary that is not the first") {
  // Along x: a wall of one voxel at 3, and a block from 6 to 9. Samples at 0, 8, …
  const CellObject both = solid_boxes({16, 8, 8}, {{{{3, 2, 2}, {4, 6, 6}}}, {{{6, 2, 2}, {10, 6, 6}}}});
  const Ray ray{{-1, 4.5, 4.5}, {1, 0, 0}};
  Hit exact, linear;
  REQUIRE(make_exact_caster(both)->first_hit(ray, exact));
  CHECK(exact.element[0] == 3);
  CHECK(exact.label == 1);
  CHECK(exact.t == Approx(4));
  REQUIRE(make_linear_caster(both, 0.5)->first_hit(ray, linear));
  CHECK(linear.element[0] == 6);
  CHECK(linear.label == 2);
  // The wall alone is not seen at all, however flat the ray.
  const CellObject wall = solid_boxes({16, 8, 8}, {{{{3, 2, 2}, {4, 6, 6}}}});
  for (const double slope : {0.0, 0.05, 0.2}) {
    const Ray flat{{-1, 4.5, 4.5}, {1, 0, slope}};
    REQUIRE(make_exact_caster(wall)->first_hit(flat, exact));
    CHECK(exact.element[0] == 3);
    CHECK_FALSE(make_linear_caster(wall, 0.5)->first_hit(flat, linear));
  }
  // Nor, at the source's finest step, is a corner that a ray just cuts off.
  for (const double depth : {0x1p-10, 0x1p-30}) {
    const Ray cut{{0.01, 3.01 - depth, 3.5}, {1, 1, 0}};  // below the wall's edge x = 3, y = 6
    const Ray above{{0.01, 3.01 + depth, 3.5}, {1, 1, 0}};
    REQUIRE(make_exact_caster(wall)->first_hit(cut, exact));
    CHECK(exact.element == Voxel{3, 5, 3});
    CHECK_FALSE(make_linear_caster(wall, 1.0 / 512)->first_hit(cut, linear));
    CHECK_FALSE(make_exact_caster(wall)->first_hit(above, exact));
  }
}

TEST_CASE(
    "source algorithm 3.3: a search inside that ends on intersected cells alone misses exits into the open") {
  Rng rng(33);
  int exits[3] = {0, 0, 0}, into_empty = 0, unseen = 0;
  for (const char* recipe :
       {"spheres:cells=6,resolution=16,seed=4", "voronoi:cells=5,resolution=12,seed=4"}) {
    const CellObject object = random_object(rng, recipe, {3, 3, 3}, 0.6);
    const auto caster = make_exact_caster(object);
    const double n = 3.0 * object.tile.resolution[0], step = 1.0 / 64;
    for (int k = 0; k < 6000; ++k) {
      const Vec3 start{rng.uniform(0, n), rng.uniform(0, n), rng.uniform(0, n)};
      const Vec3 d = normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)});
      if (tag_at(object, start) != Tag::kInside) continue;
      // Rows 4 to 16: while INSIDE step, and store a position when the cell is INTERSECTED.
      double t = 0;
      std::optional<double> stored;
      std::optional<Tag> tag = Tag::kInside;
      while (tag == Tag::kInside) {
        t += step;
        tag = tag_at(object, start + d * t);
        if (tag == Tag::kIntersected) stored = t - step;
      }
      if (tag)
        ++exits[std::size_t(*tag)];
      else
        ++into_empty;
      unseen += !stored;
      Hit hit;
      REQUIRE(caster->first_exit({start, d}, hit));
      // Corners thinner than the model's step it passes by; never anything else.
      REQUIRE(hit.t <= t + 1e-9);
      if (hit.t < t - step - 1e-9) {
        const Vec3 after = start + d * (hit.t + 1e-7);
        REQUIRE(tag_at(object, after) != Tag::kInside);
      }
    }
  }
  INFO("exits into outside cells " << exits[0] << ", intersected cells " << exits[2] << ", empty space "
                                   << into_empty);
  CHECK(exits[0] > 300);
  CHECK(exits[2] > 300);
  CHECK(into_empty > 300);
  CHECK(unseen == exits[0] + into_empty);
}

TEST_CASE("source 3.2.4: without a turned normal and total reflection glass bends rays the wrong way") {
  // The source's refraction, as GPUs have it: the normal as stored, the ratio as on the way in, and no ray
  // where the root is imaginary.
  const auto by_source = [](Vec3 d, Vec3 n, double ratio) {
    const double cosine = dot(n, d), k = 1 - ratio * ratio * (1 - cosine * cosine);
    return k < 0 ? Vec3{} : d * ratio - n * (ratio * cosine + std::sqrt(k));
  };
  const Vec3 up{0, 0, 1}, d = normalize({0.5, 0, -1});
  const Vec3 inner = *refract(d, up, 1 / 1.5);
  CHECK(length(inner - by_source(d, up, 1 / 1.5)) < 1e-15);  // on the way in they agree
  // Leaving through the face below, whose outward normal is -up, the ray goes on as it came.
  CHECK(length(*refract(inner, up, 1.5) - d) < 1e-15);
  const Vec3 wrong = by_source(inner, -up, 1 / 1.5);
  CHECK(wrong.z > 0);  // back into the glass
  CHECK(length(wrong - d) > 1);
  // Beyond the critical angle nothing is refracted; the ray is reflected, not lost.
  const Vec3 flat = normalize({1.5, 0, -1});
  CHECK(by_source(flat, up, 1.5) == Vec3{});
  CHECK_FALSE(refract(flat, up, 1.5));

  // A glass block, seen through from z = 44 to 4; all that happens is far from its edges.
  const CellObject block = solid_boxes({64, 64, 48}, {{{{1, 1, 4}, {63, 63, 44}}}});
  const auto caster = make_exact_caster(block);
  std::vector<float> picture;  // of directions
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 512; ++x) {
      const double v = (y + 0.5) / 256 * 3.14159265358979, u = ((x + 0.5) / 512 - 0.5) * 2 * 3.14159265358979;
      for (const double c : {std::sin(v) * std::sin(u), std::cos(v), -std::sin(v) * std::cos(u)})
        picture.push_back(float(c));
    }
  const Environment around(std::move(picture), 512, 256);
  const auto seen = [&](const Ray& ray, std::uint32_t events) {
    Hit hit;
    REQUIRE(caster->first_hit(ray, hit));
    Rng rng(1);
    return Radiance(*caster, {.ior = 1.5, .events = events}, around, ray.direction).of_hit(ray, hit, rng);
  };
  const Ray ray{Vec3{30, 32.5, 44} - d * 2, d};
  CHECK(length(seen(ray, 6) - d) < 0.02);
  CHECK(length(seen(ray, 6) - wrong) > 1);
  // The limit of events: after one, the ray is seen as it goes within.
  CHECK(length(seen(ray, 1) - inner) < 0.02);
  // Within it goes at 17.3° from the vertical, so it meets the side x = 63 far beyond the critical 41.8°, is
  // reflected, and leaves below, mirrored.
  const Ray side{Vec3{57, 32.5, 44} - d * 2, d};
  const Vec3 mirrored{-d.x, 0, d.z};
  CHECK(length(seen(side, 6) - mirrored) < 0.02);
}

TEST_CASE("source 4.4: tile and cell coordinates have each other's formula; ours are quotient and rest") {
  Rng rng(44);
  const CellObject object = random_object(rng, "voronoi:cells=3,resolution=5x7x6,seed=8", {4, 3, 5}, 0.5);
  const auto caster = make_exact_caster(object);
  const Index3& n = object.tile.resolution;
  int wrong = 0, voxels = 0;
  for (std::int64_t z = 0; z < 30; ++z)
    for (std::int64_t y = 0; y < 21; ++y)
      for (std::int64_t x = 0; x < 20; ++x) {
        const Voxel v{x, y, z};
        const Vec3 centre{double(x) + 0.5, double(y) + 0.5, double(z) + 0.5};
        REQUIRE(caster->inside(centre) == is_inside(object, v));
        ++voxels;
        // "tile coordinate = voxel position modulo tile's size; cell coordinate = voxel position - tile
        // coordinate"
        bool in_tile = true, in_grid = true;
        for (std::size_t a = 0; a < 3; ++a) {
          const std::int64_t tile = v[a] % n[a], cell = v[a] - tile;
          in_tile = in_tile && cell < n[a];
          in_grid = in_grid && tile < object.grid.tiles[a];
        }
        wrong += !in_tile || !in_grid;
        if (!is_inside(object, v)) continue;
        Hit hit;
        REQUIRE(caster->first_hit({centre, {0, 0, 1}}, hit));
        REQUIRE(hit.element == v);
        const std::uint64_t i = object.tile.voxel_index(std::uint32_t(x) % n[0], std::uint32_t(y) % n[1],
                                                        std::uint32_t(z) % n[2]);
        const Piece& p = object.tile.pieces[object.tile.id(i) - 1];
        REQUIRE(hit.label == p.cell);
        REQUIRE(hit.instance == std::int64_t(object.grid.tile_index(std::uint32_t(x / n[0] + p.home[0]),
                                                                    std::uint32_t(y / n[1] + p.home[1]),
                                                                    std::uint32_t(z / n[2] + p.home[2]))));
      }
  CHECK(wrong > voxels * 9 / 10);
}
