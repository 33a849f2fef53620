#include "sdk/surface/instance_colors.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/surface/color.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Colors that change smoothly with the place.
void color_by_place(TriangleMesh& mesh) {
  const Box3 box = bounding_box(mesh);
  mesh.colors.clear();
  for (const Vec3& v : mesh.vertices) {
    Rgb8 color{};
    for (std::size_t a = 0; a < 3; ++a)
      color[a] = std::uint8_t(std::lround(255 * (v[a] - box.min[a]) / box.extent()[a]));
    mesh.colors.push_back(color);
  }
}

CellObject author(const TriangleMesh& mesh, const char* tile, std::uint32_t tiles) {
  Result<CellObject> object =
      author_cell_object(mesh, *make_tile(*parse_recipe(tile)), {.grid = {.tiles = tiles}});
  REQUIRE(object.ok());
  return std::move(*object);
}

/// Centres of the INSIDE instances, metres, in the order of CellObject::instance_colors: means over all
/// voxels of the grid.
std::vector<Vec3> centres_of(const CellObject& object) {
  struct Sum {
    Vec3 place;
    double voxels = 0;
  };
  std::map<std::pair<std::uint64_t, std::uint32_t>, Sum> sums;
  const Index3& n = object.tile.resolution;
  const Index3& tiles = object.grid.tiles;
  for (std::uint32_t z = 0; z < n[2] * tiles[2]; ++z)
    for (std::uint32_t y = 0; y < n[1] * tiles[1]; ++y)
      for (std::uint32_t x = 0; x < n[0] * tiles[0]; ++x) {
        const std::uint32_t id = object.tile.id(object.tile.voxel_index(x % n[0], y % n[1], z % n[2]));
        if (id == 0) continue;
        const Piece& piece = object.tile.pieces[id - 1];
        const std::int64_t home[3] = {x / n[0] + std::int64_t{piece.home[0]},
                                      y / n[1] + std::int64_t{piece.home[1]},
                                      z / n[2] + std::int64_t{piece.home[2]}};
        bool in = true;
        for (std::size_t a = 0; a < 3; ++a) in = in && home[a] >= 0 && home[a] < std::int64_t{tiles[a]};
        if (!in) continue;
        const std::uint64_t t =
            object.grid.tile_index(std::uint32_t(home[0]), std::uint32_t(home[1]), std::uint32_t(home[2]));
        if (object.membership.tag(t, piece.cell) != Tag::kInside) continue;
        Sum& sum = sums[{t, piece.cell}];
        sum.place = sum.place + Vec3{x + 0.5, y + 0.5, z + 0.5};
        sum.voxels += 1;
      }
  std::vector<Vec3> centres;
  for (const auto& [key, sum] : sums)
    centres.push_back(to_vec3(object.grid.box_min) + sum.place / sum.voxels * object.grid.voxel_edge);
  return centres;
}

/// Shares of a triangle's corners in its point nearest to p, by the region that p is in
/// [Ericson, Real-Time Collision Detection, 5.1.5].
std::array<double, 3> nearest_shares(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / (d4 - d3 + d5 - d6);
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

/// Colors, 0…255 and not rounded, at the points of the mesh that are about nearest to p: more than one where
/// that is a matter of rounding.
std::vector<Vec3> nearest_colors(const TriangleMesh& mesh, Vec3 p) {
  struct Candidate {
    double distance;
    Vec3 color;
  };
  std::vector<Candidate> candidates;
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    const std::array<double, 3> share =
        nearest_shares(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    Vec3 q, light;
    for (std::size_t k = 0; k < 3; ++k) {
      q = q + mesh.vertices[t[k]] * share[k];
      for (std::size_t a = 0; a < 3; ++a) {
        const double s = mesh.colors[t[k]][a] / 255.0;
        light[a] += share[k] * (s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
      }
    }
    Vec3 color;
    for (std::size_t a = 0; a < 3; ++a)
      color[a] =
          255 * (light[a] <= 0.0031308 ? 12.92 * light[a] : 1.055 * std::pow(light[a], 1 / 2.4) - 0.055);
    candidates.push_back({length(q - p), color});
    least = std::min(least, length(q - p));
  }
  std::vector<Vec3> colors;
  for (const Candidate& c : candidates)
    if (c.distance <= least + 1e-9) colors.push_back(c.color);
  return colors;
}

bool rounds_to(Vec3 exact, const Rgb8& color) {
  for (std::size_t a = 0; a < 3; ++a)
    if (std::abs(exact[a] - color[a]) > 0.501) return false;
  return true;
}

void check_against_brute_force(const CellObject& object, const TriangleMesh& mesh, std::size_t least) {
  const Result<std::vector<Rgb8>> colors = make_instance_colors(object, mesh, 2);
  REQUIRE(colors.ok());
  const std::vector<Vec3> centres = centres_of(object);
  REQUIRE(centres.size() == count_instances(object.membership).inside);
  REQUIRE(centres.size() >= least);
  REQUIRE(colors->size() == centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    INFO("instance " << i);
    bool found = false;
    for (const Vec3& exact : nearest_colors(mesh, centres[i]))
      found = found || rounds_to(exact, (*colors)[i]);
    CHECK(found);
  }
}

}  // namespace

TEST_CASE("every instance has the color of the mesh that brute force finds") {
  TriangleMesh sphere = make_sphere({0.3, -0.2, 5}, 1, 12);
  color_by_place(sphere);
  check_against_brute_force(author(sphere, "voronoi:cells=8,resolution=8,seed=1", 8), sphere, 500);
  // Colors without any order, a mesh of two parts, and a tile with empty space.
  TriangleMesh parts = make_torus({0, 0, 0}, 1, 0.4, 16, 8);
  append(parts, make_box({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}));
  Rng rng(5);
  for (std::size_t i = 0; i < parts.vertices.size(); ++i)
    parts.colors.push_back(
        {std::uint8_t(rng.below(256)), std::uint8_t(rng.below(256)), std::uint8_t(rng.below(256))});
  check_against_brute_force(author(parts, "ellipsoids:cells=5,resolution=12,seed=2", 9), parts, 100);
}

TEST_CASE("a mesh of one color gives it to every instance, bit by bit") {
  TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 20);
  const CellObject object = author(sphere, "voronoi:cells=8,resolution=8,seed=3", 8);
  for (const Rgb8& color : {Rgb8{0, 0, 0}, Rgb8{1, 127, 254}, Rgb8{255, 255, 255}}) {
    sphere.colors.assign(sphere.vertices.size(), color);
    const Result<std::vector<Rgb8>> colors = make_instance_colors(object, sphere);
    REQUIRE(colors.ok());
    for (const Rgb8& c : *colors) REQUIRE(c == color);
  }
}

TEST_CASE("colors are mixed in linear light") {
  // A wall, black below and white above: half-way up is half of the light, which is 188 in sRGB, not 128.
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  for (const Vec3& v : box.vertices) box.colors.push_back(v.z > 0.5 ? Rgb8{255, 255, 255} : Rgb8{0, 0, 0});
  const CellObject object = author(box, "voronoi:cells=1,resolution=4", 9);
  const Result<std::vector<Rgb8>> colors = make_instance_colors(object, box);
  REQUIRE(colors.ok());
  const std::vector<Vec3> centres = centres_of(object);
  int mixed = 0;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const double z = centres[i].z,
                 side = std::min({centres[i].x, 1 - centres[i].x, centres[i].y, 1 - centres[i].y});
    if (side > std::min(z, 1 - z) - 1e-3) continue;  // nearest to the floor or the roof
    const double expected = 255 * (z <= 0.0031308 ? 12.92 * z : 1.055 * std::pow(z, 1 / 2.4) - 0.055);
    CHECK(rounds_to({expected, expected, expected}, (*colors)[i]));
    mixed += z > 0.4 && z < 0.6;
  }
  CHECK(mixed > 5);
}

TEST_CASE("colors depend on neither threads nor the mesh's size") {
  TriangleMesh torus = make_torus({0, 0, 0}, 3, 1, 40, 20);
  color_by_place(torus);
  const char* const tile = "voronoi:cells=8,resolution=16,seed=1";
  const Result<std::vector<Rgb8>> one = make_instance_colors(author(torus, tile, 16), torus, 1);
  REQUIRE(one.ok());
  REQUIRE(one->size() > 1000);
  CHECK(*make_instance_colors(author(torus, tile, 16), torus, 3) == *one);
  for (const double scale : {0x1p-100, 0x1p100}) {
    TriangleMesh scaled = torus;
    for (Vec3& v : scaled.vertices) v = v * scale;
    CHECK(*make_instance_colors(author(scaled, tile, 16), scaled, 2) == *one);
  }
}

TEST_CASE("what cannot be colored is refused for the right reason") {
  TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 20);
  const CellObject object = author(sphere, "voronoi:cells=8,resolution=8,seed=1", 6);
  const Result<std::vector<Rgb8>> plain = make_instance_colors(object, sphere);
  REQUIRE_FALSE(plain.ok());
  CHECK(plain.error().code == ErrorCode::kUsage);
  CHECK(plain.error().message.find("no colors") != std::string::npos);

  color_by_place(sphere);
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  CHECK(make_instance_colors(object, sphere, 2, &progress).error().code == ErrorCode::kCancelled);

  TriangleMesh bare = sphere, far = sphere;
  bare.triangles.clear();
  for (Vec3& v : far.vertices) v = v * 1e300;
  CHECK(make_instance_colors(object, bare).error().code == ErrorCode::kInvalidInput);
  CHECK(make_instance_colors(object, far).error().code == ErrorCode::kInvalidInput);
  // A vertex that no triangle uses may be anywhere.
  sphere.vertices.push_back({1e308, -1e308, 0});
  sphere.colors.push_back({1, 2, 3});
  CHECK(make_instance_colors(object, sphere).ok());

  CellObject nothing = object;
  nothing.membership.entries.assign(nothing.membership.entries.size(), std::uint32_t(Tag::kOutside));
  nothing.membership.blocks.clear();
  CHECK(make_instance_colors(nothing, sphere)->empty());
}

TEST_CASE("colors of instances come in place of others, and not if they cannot be had") {
  TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 20);
  color_by_place(sphere);
  Colors own;
  const SurfacePaint unpainted;
  own.field = [&](const CellObject& o, unsigned threads, const Progress*) {
    return make_mesh_color_field(o.grid, sphere, unpainted, threads);
  };
  CellObject object = author(sphere, "voronoi:cells=8,resolution=8,seed=1", 6);
  object.cell_colors.emplace().colors.assign(8, {1, 2, 3});
  const CellObject before = object;
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  CHECK(apply_colors(own, object, 1, &progress).error().code == ErrorCode::kCancelled);
  CHECK(object == before);
  REQUIRE(apply_colors(own, object));
  CHECK(object.instance_colors->colors == *make_instance_colors(object, sphere));
  CHECK_FALSE(object.cell_colors.has_value());
  CHECK_FALSE(object.color.has_value());
  REQUIRE(apply_colors(*make_colors(*parse_recipe("marble:resolution=8"), 8), object));
  CHECK_FALSE(object.instance_colors.has_value());
  CHECK(object.color.has_value());
}

TEST_CASE("what is painted on a mesh comes into the colors of its instances") {
  TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 20);
  const CellObject object = author(sphere, "voronoi:cells=8,resolution=8,seed=1", 6);
  SurfacePaint paint;
  CHECK(make_instance_colors(object, sphere, paint).error().code == ErrorCode::kUsage);
  paint.materials = {{{1, 0, 0}, {}}, {{0, 1, 0}, {}}};
  for (const Triangle& t : sphere.triangles)
    paint.material_indices.push_back(
        sphere.vertices[t[0]].z + sphere.vertices[t[1]].z + sphere.vertices[t[2]].z > 0 ? 1 : 0);
  const Result<std::vector<Rgb8>> colors = make_instance_colors(object, sphere, paint, 2);
  REQUIRE(colors);
  const std::vector<Vec3> centres = centres_of(object);
  REQUIRE(colors->size() == centres.size());
  std::size_t checked = 0;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (std::abs(centres[i].z) < 0.2) continue;
    ++checked;
    CHECK((*colors)[i] == (centres[i].z > 0 ? Rgb8{0, 255, 0} : Rgb8{255, 0, 0}));
  }
  CHECK(checked > 100);
}
