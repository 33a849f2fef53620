#include "sdk/author/mesh_tile.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "format/cell_object_io.h"
#include "sdk/author/tile_sample.h"
#include "sdk/core/rng.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/support/catch.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

struct Claim {
  std::uint32_t cell;
  std::array<std::int32_t, 3> image;  ///< z, y, x: minus the tile that the voxel was in
  bool operator<(const Claim& other) const {
    return std::tie(cell, image) < std::tie(other.cell, other.image);
  }
};

/// All claims on each voxel of the tile, from the definition of inside. Meshes are in voxels and lie within
/// `reach` tiles of the tile at the origin.
std::vector<std::set<Claim>> claims_by_definition(const std::vector<TriangleMesh>& cells, const Index3& n,
                                                  std::uint32_t reach) {
  std::vector<std::set<Claim>> claims(n[0] * n[1] * n[2]);
  const std::uint32_t tiles = 2 * reach + 1;
  const Index3 whole{n[0] * tiles, n[1] * tiles, n[2] * tiles};
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    TriangleMesh moved = cells[c];
    for (Vec3& v : moved.vertices)
      v = v + Vec3{double(n[0] * reach), double(n[1] * reach), double(n[2] * reach)};
    const std::vector<bool> inside = inside_by_definition(moved, whole);
    for (std::uint32_t z = 0; z < whole[2]; ++z)
      for (std::uint32_t y = 0; y < whole[1]; ++y)
        for (std::uint32_t x = 0; x < whole[0]; ++x)
          if (inside[x + whole[0] * (y + whole[1] * z)]) {
            const auto image = [&](std::uint32_t v, std::size_t a) {
              return std::int32_t(reach) - std::int32_t(v / n[a]);
            };
            claims[x % n[0] + n[0] * (y % n[1] + n[1] * (z % n[2]))].insert(
                {c + 1, {image(z, 2), image(y, 1), image(x, 0)}});
          }
  }
  return claims;
}

}  // namespace

TEST_CASE("a tile of meshes gives each voxel to the first mesh that it is inside of, around the border") {
  Rng rng(77);
  std::uint64_t wrapped = 0, contested = 0;
  for (int round = 0; round < 12; ++round) {
    const Index3 n{8 + rng.below(9), 8 + rng.below(9), 8 + rng.below(9)};
    std::vector<TriangleMesh> cells;
    for (std::uint32_t c = 0, count = 1 + rng.below(5); c < count; ++c) {
      // Whole and half coordinates put vertices and faces on voxel centres.
      const auto coordinate = [&](double low, double high) {
        return round % 2 ? rng.uniform(low, high) : std::round(2 * rng.uniform(low, high)) / 2;
      };
      const Vec3 at{coordinate(-0.5 * n[0], 1.4 * n[0]), coordinate(-0.5 * n[1], 1.4 * n[1]),
                    coordinate(-0.5 * n[2], 1.4 * n[2])};
      const double size = coordinate(1, 5);
      switch (rng.below(3)) {
        case 0:
          cells.push_back(make_box(at - Vec3{size, 2, 3}, at + Vec3{2, size, 1}));
          break;
        case 1:
          cells.push_back(make_sphere(at, size, 6));
          break;
        default:
          cells.push_back(make_torus(at, size, size / 3, 9, 7));
      }
    }
    const std::vector<std::set<Claim>> claims = claims_by_definition(cells, n, 2);
    // A placement of which voxels are found exactly.
    const TilePlacement placement{{16, -8, 4}, 0.25};
    std::vector<TriangleMesh> in_metres = cells;
    for (TriangleMesh& mesh : in_metres)
      for (Vec3& v : mesh.vertices) v = placement.origin + v * placement.voxel_edge;
    TileReport report;
    const Result<TileMap> tile = make_mesh_tile(in_metres, n, placement, 2, &report);
    REQUIRE(tile);

    std::set<std::uint32_t> used;
    std::uint64_t over = 0;
    for (const std::set<Claim>& claim : claims)
      if (!claim.empty()) {
        used.insert(claim.begin()->cell);
        over += claim.size() - 1;
      }
    REQUIRE(tile->cell_count == used.size());
    CHECK(report.dropped_cells == cells.size() - used.size());
    CHECK(report.contested_voxels == over);
    contested += over;
    // Images of one cell relate to its pieces' homes by a constant.
    std::map<std::uint32_t, std::array<std::int32_t, 3>> constant;
    for (std::uint64_t i = 0; i < claims.size(); ++i) {
      const std::uint32_t id = tile->id(i);
      REQUIRE((id == 0) == claims[i].empty());
      if (id == 0) continue;
      const Claim& claim = *claims[i].begin();
      const Piece& piece = tile->pieces[id - 1];
      REQUIRE(piece.cell == std::uint32_t(std::distance(used.begin(), used.find(claim.cell))) + 1);
      const std::array<std::int32_t, 3> offset{claim.image[2] - piece.home[0], claim.image[1] - piece.home[1],
                                               claim.image[0] - piece.home[2]};
      REQUIRE(constant.emplace(piece.cell, offset).first->second == offset);
      wrapped += claim.image != std::array<std::int32_t, 3>{};
    }
    CHECK(encode_cell_object(make_tile_sample(*tile)));
  }
  CHECK(wrapped > 1000);
  CHECK(contested > 100);
}

TEST_CASE("a mesh falls into the parts that have no vertex in common") {
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 5);
  append(mesh, make_box({2, 2, 2}, {3, 3, 3}));
  // A box that shares one corner, by place and not by index, is no part of its own.
  append(mesh, make_box({3, 3, 3}, {4, 4, 4}));
  append(mesh, make_box({7, 7, 7}, {8, 8, 8}));
  const std::vector<TriangleMesh> parts = split_into_parts(mesh);
  REQUIRE(parts.size() == 3);
  CHECK(signed_volume(parts[1]) == Approx(2));
  CHECK(signed_volume(parts[2]) == Approx(1));
  CHECK(parts[0].triangles.size() + parts[1].triangles.size() + parts[2].triangles.size() ==
        mesh.triangles.size());
  CHECK(split_into_parts({}).empty());
}

TEST_CASE("a tile is placed around a box, with room or with a size of its own") {
  const Box3 box{{1, 2, 3}, {5, 4, 4}};
  const TilePlacement fitting = place_tile(box, {34, 18, 18}, 0);
  CHECK(fitting.voxel_edge == Approx(0.125));
  CHECK(fitting.origin.x == Approx(1 - 0.125));
  CHECK(fitting.origin.y == Approx(2 - 0.125));
  const TilePlacement sized = place_tile(box, {32, 16, 16}, 2);
  CHECK(sized.voxel_edge == 2.0 / 32);
  CHECK(sized.origin.x == 2);
}

TEST_CASE("meshes that make no tile are refused with a reason") {
  const Index3 n{16, 16, 16};
  const TilePlacement unit{{0, 0, 0}, 1.0 / 16};
  const auto error = [&](std::vector<TriangleMesh> cells, const TilePlacement& placement,
                         const Progress* progress = nullptr) {
    const Result<TileMap> tile = make_mesh_tile(cells, n, placement, 1, nullptr, progress);
    REQUIRE(!tile);
    return tile.error();
  };
  const TriangleMesh sphere = make_sphere({0.5, 0.5, 0.5}, 0.4, 8);
  TriangleMesh open = sphere;
  open.triangles.pop_back();
  CHECK(error({sphere, open}, unit).code == ErrorCode::kInvalidInput);
  CHECK(error({sphere, open}, unit).message.find("part 2") != std::string::npos);
  CHECK(error({make_sphere({0.5, 0.5, 0.5}, 1e-3, 8)}, unit).code == ErrorCode::kInvalidInput);
  CHECK(error({sphere}, {{0, 0, 0}, 0}).code == ErrorCode::kUsage);
  CHECK(error({sphere}, {{0, 0, 0}, std::nan("")}).code == ErrorCode::kUsage);
  CHECK(error({sphere}, {{0, 0, 0}, 1e-6}).code == ErrorCode::kLimit);
  CHECK(error({sphere}, {{1e30, 0, 0}, 1}).code == ErrorCode::kLimit);
  CHECK(error({}, unit).code == ErrorCode::kInvalidInput);
  std::atomic<bool> cancel = true;
  const Progress progress{{}, &cancel};
  CHECK(error({sphere}, unit, &progress).code == ErrorCode::kCancelled);
}

TEST_CASE("a tile sample shows each cell of a tile once, whole") {
  for (const char* recipe : {"voronoi:cells=3,resolution=12", "voronoi:cells=1,resolution=8",
                             "spheres:cells=5,resolution=16x12x20", "bricks:cells=4,resolution=16"}) {
    CAPTURE(recipe);
    const TileMap tile = *make_tile(*parse_recipe(recipe));
    const CellObject sample = make_tile_sample(tile);
    const Result<std::vector<std::byte>> bytes = encode_cell_object(sample);
    REQUIRE(bytes);
    CHECK(*read_cell_object(*bytes) == sample);
    CHECK(count_instances(sample.membership).inside == tile.cell_count);
    // As many voxels are inside as the tile has that are not empty.
    const auto caster = make_cell_object_caster(sample, "exact");
    REQUIRE(caster);
    std::uint64_t filled = 0, inside = 0;
    for (std::uint64_t i = 0; i < tile.voxel_count(); ++i) filled += tile.id(i) != 0;
    const auto size = [&](std::size_t a) { return sample.grid.tiles[a] * tile.resolution[a]; };
    for (std::uint32_t z = 0; z < size(2); ++z)
      for (std::uint32_t y = 0; y < size(1); ++y)
        for (std::uint32_t x = 0; x < size(0); ++x)
          inside += (*caster)->inside(to_vec3(sample.grid.box_min) +
                                      Vec3{x + 0.5, y + 0.5, z + 0.5} * sample.grid.voxel_edge);
    CHECK(inside == filled);
  }
}
