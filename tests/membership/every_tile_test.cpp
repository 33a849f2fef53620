#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "converters/import/mesh_file.h"
#include "sdk/author/mesh_tile.h"
#include "sdk/core/rng.h"
#include "sdk/membership/membership.h"
#include "sdk/tiles/labels.h"
#include "sdk/tiles/random_rotation.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Every generator, with each value of the options that change what it does.
constexpr std::array<const char*, 10> kRecipes = {
    "voronoi:metric=euclidean",
    "voronoi:metric=anisotropic",
    "voronoi:metric=additive",
    "voronoi:metric=multiplicative",
    "spheres:",
    "ellipsoids:flatness=0.7",
    "worley:keep=above,threshold=0.15",
    "worley:keep=below,combine=f1,threshold=0.45",
    "worley:keep=above,combine=2*f3-f1+0.5*f4,threshold=1.7",
    "bricks:mortar=0.2",
};

struct NamedTile {
  std::string name;  ///< tiles of one name are summed up in one line
  TileMap tile;
};

/// Labels of the nearest of some points, empty far from all; what reaches the border ends there, or goes on
/// with what is labelled alike, and may meet its own copy.
LabelVolume random_labels(const Index3& n, std::uint32_t points, Rng& rng) {
  LabelVolume volume{n, {}};
  std::vector<Vec3> at;
  for (std::uint32_t k = 0; k < points; ++k)
    at.push_back({rng.uniform(0, n[0]), rng.uniform(0, n[1]), rng.uniform(0, n[2])});
  const double reach = 0.8 * std::cbrt(double(volume.voxel_count()) / points);
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t y = 0; y < n[1]; ++y)
      for (std::uint32_t x = 0; x < n[0]; ++x) {
        std::uint32_t label = 0;
        double nearest = reach;
        for (std::uint32_t k = 0; k < points; ++k)
          if (const double d = length(Vec3{x + 0.5, y + 0.5, z + 0.5} - at[k]); d < nearest) {
            nearest = d;
            label = 1 + k % 16;
          }
        volume.labels.push_back(label);
      }
  return volume;
}

/// Balls that stick out of the tile, in voxels of it, one alone overlapping its own copies; and a rod through
/// several tiles.
std::vector<TriangleMesh> random_solids(const Index3& n, std::uint32_t count, Rng& rng) {
  const Vec3 tip{3.2 * n[0], 2.1 * n[1], 2.2 * n[2]};
  std::vector<TriangleMesh> solids{make_tetrahedron({1, 1, 1}, {5, 1, 1}, {1, 5, 1}, tip)};
  const double radius = 0.55 * std::cbrt(double(n[0]) * n[1] * n[2] / count);
  for (std::uint32_t k = 0; k < count; ++k)
    solids.push_back(
        make_sphere({rng.uniform(0, n[0]), rng.uniform(0, n[1]), rng.uniform(0, n[2])}, radius, 6));
  return solids;
}

/// All that is compared at a resolution.
std::vector<NamedTile> tiles_to_compare(const Index3& resolution, Rng& rng) {
  std::vector<NamedTile> tiles;
  for (const std::string name : kRecipes)
    for (const std::uint32_t cells : {1u, 24u}) {
      const bool bricks = name.starts_with("bricks");  // in running bond, so one is too few
      const std::string recipe = name + (name.back() == ':' ? "" : ",") +
                                 "cells=" + std::to_string(bricks && cells == 1 ? 2 : cells) +
                                 ",resolution=" + std::to_string(resolution[0]) + "x" +
                                 std::to_string(resolution[1]) + "x" + std::to_string(resolution[2]) +
                                 ",seed=" + std::to_string(rng.bits(30));
      INFO(recipe);
      Result<TileMap> tile = make_tile(*parse_recipe(recipe));
      REQUIRE(tile.ok());
      tiles.push_back({name, std::move(*tile)});
    }
  const auto add = [&](const char* name, Result<TileMap> tile) {
    INFO(name);
    REQUIRE(tile.ok());
    tiles.push_back({name, std::move(*tile)});
  };
  for (const std::uint32_t cells : {1u, 24u}) {
    add("import: labels", make_label_tile(random_labels(resolution, cells, rng), Percolating::kCut));
    add("import: meshes", make_mesh_tile(random_solids(resolution, cells, rng), resolution, {{0, 0, 0}, 1}));
  }
  return tiles;
}

TriangleMesh turned(TriangleMesh mesh, Vec3 to, Rng& rng) {
  const Rotation r = random_rotation(rng);
  for (Vec3& v : mesh.vertices)
    v = Vec3{r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
             r[6] * v.x + r[7] * v.y + r[8] * v.z} +
        to;
  return mesh;
}

Vec3 middle_of(const Index3& voxels) {
  return Vec3{double(voxels[0]), double(voxels[1]), double(voxels[2])} * 0.5;
}

/// That pieces are at home where their instance's first voxel in storage order is. [spec 4.2]
bool homes_are_first(const TileMap& tile) {
  using Place = std::array<std::int64_t, 3>;  // z, y, x
  std::map<std::uint32_t, Place> first;
  const Index3& n = tile.resolution;
  std::uint64_t i = 0;
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t y = 0; y < n[1]; ++y)
      for (std::uint32_t x = 0; x < n[0]; ++x, ++i) {
        const std::uint32_t id = tile.id(i);
        if (id == 0) continue;
        const Piece& p = tile.pieces[id - 1];
        const Place at{z - p.home[2] * std::int64_t{n[2]}, y - p.home[1] * std::int64_t{n[1]},
                       x - p.home[0] * std::int64_t{n[0]}};
        const auto [place, added] = first.emplace(p.cell, at);
        if (!added && at < place->second) place->second = at;
      }
  for (const auto& [cell, place] : first)
    for (std::size_t a = 0; a < 3; ++a)
      if (place[a] < 0 || place[a] >= n[2 - a]) return false;
  return first.size() == tile.cell_count;
}

/// A mesh for a grid of about 45 voxels along each axis, in voxels of it.
using MakeMesh = std::function<TriangleMesh(const Index3& voxels, Rng& rng)>;

/// Compares every tag that every tile gets from a mesh, by both rules, with its definition.
void compare_tiles(std::uint64_t seed, const MakeMesh& make_mesh) {
  Rng rng(seed);
  struct Sum {
    std::uint64_t tiles = 0, compared = 0;
    std::array<std::array<std::uint64_t, 3>, 2> tags{};  // by rule, then tag
  };
  std::map<std::string, Sum> sums;
  std::uint64_t compared = 0;
  int farthest = 0;  // tiles from a piece to its home
  struct Setting {
    Index3 resolution, tiles;
  };
  for (const Setting& s : {Setting{{9, 9, 9}, {5, 5, 5}}, Setting{{6, 16, 9}, {7, 3, 5}}}) {
    const Index3 voxels{s.resolution[0] * s.tiles[0], s.resolution[1] * s.tiles[1],
                        s.resolution[2] * s.tiles[2]};
    const TriangleMesh mesh = make_mesh(voxels, rng);
    const std::vector<bool> inside = inside_by_definition(mesh, voxels);
    const std::vector<bool> touched = touched_by_definition(mesh, voxels);
    for (const NamedTile& t : tiles_to_compare(s.resolution, rng)) {
      Sum& sum = sums[t.name];
      ++sum.tiles;
      for (const Piece& p : t.tile.pieces)
        for (const std::int8_t h : p.home) farthest = std::max(farthest, std::abs(h));
      for (const MembershipRule rule : {MembershipRule::kCentre, MembershipRule::kConservative}) {
        const bool conservative = rule == MembershipRule::kConservative;
        INFO(t.name << ", " << t.tile.cell_count << " cells of " << s.resolution[0] << "x" << s.resolution[1]
                    << "x" << s.resolution[2] << ", " << (conservative ? "conservative" : "centre"));
        REQUIRE(t.tile.resolution == s.resolution);
        REQUIRE(homes_are_first(t.tile));
        const std::vector<Tag> expected =
            tags_by_definition(inside, s.tiles, t.tile, conservative ? touched : std::vector<bool>{});
        const Result<MembershipMap> map =
            compute_membership(mesh, s.tiles, t.tile, {.rule = rule, .threads = 1 + rng.below(3)});
        REQUIRE(map.ok());
        REQUIRE(map->rule == rule);
        REQUIRE(expected.size() == map->entries.size() * t.tile.cell_count);
        CHECK(wrong_tags(*map, expected) == 0);
        sum.compared += expected.size();
        compared += expected.size();
        for (const Tag tag : expected) ++sum.tags[conservative][std::size_t(tag)];
      }
    }
  }
  std::printf("tags compared with brute force; inside : outside : intersected\n");
  for (const auto& [name, sum] : sums) {
    std::printf("  %-56s %2llu tiles %7llu instances", name.c_str(), (unsigned long long)sum.tiles,
                (unsigned long long)sum.compared);
    for (std::size_t rule = 0; rule < 2; ++rule)
      std::printf("  %s %llu : %llu : %llu", rule ? "conservative" : "centre",
                  (unsigned long long)sum.tags[rule][std::size_t(Tag::kInside)],
                  (unsigned long long)sum.tags[rule][std::size_t(Tag::kOutside)],
                  (unsigned long long)sum.tags[rule][std::size_t(Tag::kIntersected)]);
    std::printf("\n");
    // A comparison of nothing but empty space would prove nothing.
    for (const auto& tags : sum.tags)
      for (const std::uint64_t n : tags) CHECK(n > 20);
    // What the surface touches between the centres only the conservative rule sees.
    CHECK(sum.tags[1][std::size_t(Tag::kInside)] < sum.tags[0][std::size_t(Tag::kInside)]);
  }
  std::printf("  in all: %llu instances\n", (unsigned long long)compared);
  CHECK(compared > 100000);
  CHECK(farthest >= 2);
}

}  // namespace

TEST_CASE("the table of tiles names every generator and every choice that it offers") {
  std::string table;
  for (const char* recipe : kRecipes) table += std::string(recipe) + ",";
  int choices = 0;
  const auto find = [&](const std::string& choice) {
    INFO(choice);
    CHECK(table.find(choice) != std::string::npos);
    ++choices;
  };
  // Words such as "voronoi:cells=8,resolution=64,seed=1" and "metric=euclidean|anisotropic,".
  std::istringstream help(tile_generators_help());
  for (std::string word; help >> word;) {
    if (const std::size_t options = word.find(":cells="); options != std::string::npos)
      find(word.substr(0, options + 1));
    if (word.find('|') == std::string::npos) continue;
    const std::string option = word.substr(0, word.find('=') + 1);
    std::istringstream values(word.substr(option.size()));
    for (std::string value; std::getline(values, value, '|');) find(option + value + ",");
  }
  CHECK(choices == 5 + 4 + 2);
}

TEST_CASE("both membership rules equal brute force for every tile: torus", "[slow]") {
  compare_tiles(20110, [](const Index3& voxels, Rng& rng) {
    return turned(make_torus({0, 0, 0}, 13, 8, 24, 14), middle_of(voxels), rng);
  });
}

TEST_CASE("both membership rules equal brute force for every tile: overlapping shells") {
  compare_tiles(20111, [](const Index3& voxels, Rng& rng) {
    // A box on voxel faces, a ball that overlaps it and leaves the grid, a cavity, and a box turned inside
    // out that sticks out.
    TriangleMesh shells = make_box({4, 5, 6}, {37, 34, 31});
    append(shells, turned(make_sphere({0, 0, 0}, 13, 9), middle_of(voxels) + Vec3{16, 15, 10}, rng));
    TriangleMesh cavity = turned(make_sphere({0, 0, 0}, 5, 8), {15, 15, 15}, rng);
    flip(cavity);
    append(shells, cavity);
    TriangleMesh inverted = make_box({15.5, 19.25, 15}, {33, 46.5, 27.75});
    flip(inverted);
    append(shells, inverted);
    return shells;
  });
}

TEST_CASE("both membership rules equal brute force for every tile: a real mesh", "[slow]") {
  const auto path = find_data("meshes/spot.obj");
  if (!path) {
    WARN("spot.obj is not here; skipped");
    return;
  }
  const Result<TriangleMesh> spot = read_mesh_file(*path);
  REQUIRE(spot.ok());
  compare_tiles(20112, [&](const Index3& voxels, Rng&) {
    const Box3 box = bounding_box(*spot);
    const Vec3 extent = box.extent();
    const double scale =
        (std::min({voxels[0], voxels[1], voxels[2]}) - 2) / std::max({extent.x, extent.y, extent.z});
    TriangleMesh mesh = *spot;
    for (Vec3& v : mesh.vertices) v = (v - (box.min + box.max) * 0.5) * scale + middle_of(voxels);
    return mesh;
  });
}
