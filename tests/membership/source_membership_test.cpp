// Where the source's rules for membership go wrong, and ours do not. [Nürnberg 2011, 3.1.3-3.1.5, 4.3-4.5]
#include <algorithm>
#include <array>
#include <vector>

#include "sdk/author/cell_object.h"
#include "sdk/membership/membership.h"
#include "sdk/tiles/labels.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/membership_oracle.h"
#include "tests/support/shapes.h"
#include "tests/support/source_rules.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

LabelVolume blank(const Index3& n) { return {n, std::vector<std::uint32_t>(n[0] * n[1] * n[2], 0)}; }

/// Gives the voxels of a box, [low, high), to a label.
void fill(LabelVolume& volume, const Index3& low, const Index3& high, std::uint32_t label) {
  for (std::uint32_t z = low[2]; z < high[2]; ++z)
    for (std::uint32_t y = low[1]; y < high[1]; ++y)
      for (std::uint32_t x = low[0]; x < high[0]; ++x)
        volume.labels[x + volume.resolution[0] * (y + volume.resolution[1] * z)] = label;
}

TileMap tile_of(const LabelVolume& volume) {
  Result<TileMap> tile = make_label_tile(volume, Percolating::kRefuse);
  REQUIRE(tile.ok());
  return std::move(*tile);
}

Tag tag_of(bool in, bool out) { return !out ? Tag::kInside : !in ? Tag::kOutside : Tag::kIntersected; }

/// Which of the source's rules are followed.
struct Rules {
  bool slot_by_face_code = false;  ///< pieces of one cell with one face code share their tag [4.3]
  bool shift_by_face_code =
      false;  ///< neighbours' tiles are found by face codes [algorithm 4.7], not by home
};

/// The source's determination and merger of tags [algorithms 4.4, 4.6]: the tag of piece k in tile t is at
/// t · pieces + k.
std::vector<Tag> merge_split_cells(const std::vector<bool>& inside, const Index3& tiles, const TileMap& tile,
                                   const Rules& rules) {
  const std::size_t pieces = tile.pieces.size();
  const Index3& n = tile.resolution;
  const std::vector<std::uint8_t> codes = face_codes(tile);
  const auto tile_index = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    return std::size_t(x + tiles[0] * (y + tiles[1] * z));
  };
  std::vector<std::array<bool, 2>> seen(tiles[0] * tiles[1] * tiles[2] * pieces);  // not inside, inside
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < tiles[2] * n[2]; ++z)
    for (std::uint32_t y = 0; y < tiles[1] * n[1]; ++y)
      for (std::uint32_t x = 0; x < tiles[0] * n[0]; ++x, ++i) {
        const std::uint32_t id = tile.id(tile.voxel_index(x % n[0], y % n[1], z % n[2]));
        if (id == 0) continue;
        const std::size_t t = tile_index(x / n[0], y / n[1], z / n[2]);
        for (std::size_t k = 0; k < pieces; ++k)
          if (k + 1 == id || (rules.slot_by_face_code && tile.pieces[k].cell == tile.pieces[id - 1].cell &&
                              codes[k] == codes[id - 1]))
            seen[t * pieces + k][inside[i]] = true;
      }
  std::vector<Tag> tags;
  for (std::int64_t z = 0; z < tiles[2]; ++z)
    for (std::int64_t y = 0; y < tiles[1]; ++y)
      for (std::int64_t x = 0; x < tiles[0]; ++x)
        for (std::size_t k = 0; k < pieces; ++k) {
          bool in = false, out = false;
          for (std::size_t j = 0; j < pieces; ++j) {
            const Piece &p = tile.pieces[k], &q = tile.pieces[j];
            if (p.cell != q.cell) continue;
            std::array<std::int32_t, 3> s{p.home[0] - q.home[0], p.home[1] - q.home[1],
                                          p.home[2] - q.home[2]};
            if (rules.shift_by_face_code)
              s = j == k ? std::array<std::int32_t, 3>{} : shift_by_face_codes(codes[k], codes[j]);
            const std::int64_t u = x + s[0], v = y + s[1], w = z + s[2];
            if (u < 0 || v < 0 || w < 0 || u >= tiles[0] || v >= tiles[1] || w >= tiles[2]) {
              out = true;
              continue;
            }
            const std::array<bool, 2>& other = seen[tile_index(u, v, w) * pieces + j];
            out = out || other[0];
            in = in || other[1];
          }
          tags.push_back(tag_of(in, out));
        }
  return tags;
}

/// For how many pieces of tiles, with their home in the grid, such tags differ from a membership map's.
std::size_t differing(const std::vector<Tag>& tags, const MembershipMap& map, const TileMap& tile) {
  std::size_t count = 0, i = 0;
  for (std::int64_t z = 0; z < map.tiles[2]; ++z)
    for (std::int64_t y = 0; y < map.tiles[1]; ++y)
      for (std::int64_t x = 0; x < map.tiles[0]; ++x)
        for (const Piece& p : tile.pieces) {
          const std::int64_t u = x + p.home[0], v = y + p.home[1], w = z + p.home[2];
          const Tag tag = tags[i++];
          if (u < 0 || v < 0 || w < 0 || u >= map.tiles[0] || v >= map.tiles[1] || w >= map.tiles[2])
            continue;
          count += tag != map.tag(std::uint64_t(u + map.tiles[0] * (v + map.tiles[1] * w)), p.cell);
        }
  return count;
}

struct BySource {
  std::size_t by_source, by_pieces;  ///< pieces whose tags differ from ours
};

/// Our tags, which must be those of the definition, against the source's merger with and without its rules.
BySource compare(const TriangleMesh& mesh, const Index3& tiles, const TileMap& tile, const Rules& rules) {
  const std::vector<bool> inside = inside_by_definition(mesh, voxels_of(tiles, tile));
  const Result<MembershipMap> map = compute_membership(mesh, tiles, tile);
  REQUIRE(map.ok());
  REQUIRE(wrong_tags(*map, tags_by_definition(inside, tiles, tile)) == 0);
  const InstanceCounts n = count_instances(*map);
  REQUIRE(n.inside > 0);
  REQUIRE(n.outside > 0);
  REQUIRE(n.intersected > 0);
  return {differing(merge_split_cells(inside, tiles, tile, rules), *map, tile),
          differing(merge_split_cells(inside, tiles, tile, {}), *map, tile)};
}

}  // namespace

TEST_CASE("source 4.3: pieces with one face code share a slot, so that cells which fit are lost") {
  // A cell that goes along x through three tiles, ending 3 voxels higher in each: all its pieces touch both
  // faces.
  LabelVolume thread = blank({8, 11, 8});
  for (std::uint32_t k = 0; k < 3; ++k) {
    fill(thread, {0, 3 * k, 2}, {5, 3 * k + 1, 3}, 1);
    for (std::uint32_t x = 5; x < 8; ++x) fill(thread, {x, 3 * k + x - 4, 2}, {x + 1, 3 * k + x - 3, 3}, 1);
  }
  const TileMap tile = tile_of(thread);
  REQUIRE(tile.pieces.size() == 3);
  // The mesh covers five tiles, and of the sixth the part where a cell ends, but not where the next goes on.
  TriangleMesh mesh = make_box({-1, -1, -1}, {40, 12, 9});
  append(mesh, make_box({39, 6.2, -1}, {48, 12, 9}));
  const BySource c = compare(mesh, {9, 1, 1}, tile, {.slot_by_face_code = true});
  CHECK(c.by_source > 0);
  CHECK(c.by_pieces == 0);
}

TEST_CASE(
    "source algorithm 4.7: neighbours across z are sought along x, and beyond a piece that spans the tile 3 "
    "tiles on") {
  const TriangleMesh ball = make_sphere({20.2, 19.7, 20.4}, 17, 12);
  const Rules by_codes{.shift_by_face_code = true};
  // What crosses x or y alone is found: the model is the source's.
  LabelVolume across_x = blank({8, 8, 8}), across_y = across_x, across_z = across_x, across_two = across_x;
  fill(across_x, {6, 3, 3}, {8, 5, 5}, 1);
  fill(across_x, {0, 3, 3}, {2, 5, 5}, 1);
  fill(across_y, {3, 6, 3}, {5, 8, 5}, 1);
  fill(across_y, {3, 0, 3}, {5, 2, 5}, 1);
  for (const LabelVolume& good : {across_x, across_y}) {
    const BySource c = compare(ball, {5, 5, 5}, tile_of(good), by_codes);
    CHECK(c.by_source == 0);
    CHECK(c.by_pieces == 0);
  }
  CHECK(shift_by_face_codes(1, 2) == std::array<std::int32_t, 3>{-1, 0, 0});  // table 4.3
  // Row 17 writes the shift along z into that along x.
  fill(across_z, {3, 3, 6}, {5, 5, 8}, 1);
  fill(across_z, {3, 3, 0}, {5, 5, 2}, 1);
  CHECK(shift_by_face_codes(16, 32) == std::array<std::int32_t, 3>{-1, 0, 0});  // it should be 0, 0, -1
  const BySource z = compare(ball, {5, 5, 5}, tile_of(across_z), by_codes);
  CHECK(z.by_source > 0);
  CHECK(z.by_pieces == 0);
  // A piece that touches two opposite faces gives a shift of 3 tiles: from the middle of a cell of three
  // pieces.
  fill(across_two, {5, 1, 3}, {8, 2, 4}, 1);
  fill(across_two, {0, 1, 3}, {4, 2, 4}, 1);
  fill(across_two, {3, 1, 3}, {4, 4, 4}, 1);
  fill(across_two, {3, 3, 3}, {8, 4, 4}, 1);
  fill(across_two, {0, 3, 3}, {2, 4, 4}, 1);
  const TileMap three = tile_of(across_two);
  REQUIRE(three.cell_count == 1);
  REQUIRE(three.pieces.size() == 3);
  CHECK(shift_by_face_codes(3, 1) == std::array<std::int32_t, 3>{3, 0, 0});  // it should be 1, 0, 0
  const BySource two = compare(ball, {5, 5, 5}, three, by_codes);
  CHECK(two.by_source > 0);
  CHECK(two.by_pieces == 0);
}

TEST_CASE("source 3.1.3: cells that meet their own copies become one without end, which no mesh holds") {
  const Index3 tiles{5, 5, 5};
  const TriangleMesh ball = make_sphere({30, 30, 30}, 28, 16);
  for (const char* recipe :
       {"voronoi:cells=1,resolution=12,seed=5", "voronoi:cells=2,resolution=12,seed=5"}) {
    const TileMap tile = *make_tile(*parse_recipe(recipe));
    // The source's cell: voxels of one index that are connected, in the whole tiling.
    const Index3 n = voxels_of(tiles, tile);
    const std::vector<bool> inside = inside_by_definition(ball, n);
    std::vector<std::uint32_t> cell;
    for (std::uint32_t z = 0; z < n[2]; ++z)
      for (std::uint32_t y = 0; y < n[1]; ++y)
        for (std::uint32_t x = 0; x < n[0]; ++x)
          cell.push_back(tile.pieces[tile.id(tile.voxel_index(x % 12, y % 12, z % 12)) - 1].cell);
    std::vector<bool> reached(cell.size());
    std::uint64_t inside_cells = 0, cells = 0;
    for (std::size_t start = 0; start < cell.size(); ++start) {
      if (reached[start]) continue;
      std::vector<std::size_t> queue{start};
      reached[start] = true;
      bool in = false, out = false;
      while (!queue.empty()) {
        const std::size_t i = queue.back();
        queue.pop_back();
        (inside[i] ? in : out) = true;
        for (int d = 0; d < 27; ++d) {
          const std::int64_t x = std::int64_t(i % n[0]) + d % 3 - 1;
          const std::int64_t y = std::int64_t(i / n[0] % n[1]) + d / 3 % 3 - 1;
          const std::int64_t z = std::int64_t(i / n[0] / n[1]) + d / 9 - 1;
          if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2]) continue;
          const std::size_t j = std::size_t(x + n[0] * (y + n[1] * z));
          if (reached[j] || cell[j] != cell[i]) continue;
          reached[j] = true;
          queue.push_back(j);
        }
      }
      ++cells;
      inside_cells += tag_of(in, out) == Tag::kInside;
    }
    INFO(recipe << ": " << cells << " cells");
    CHECK(inside_cells == 0);

    const Result<MembershipMap> map = compute_membership(ball, tiles, tile);
    REQUIRE(map.ok());
    CHECK(wrong_tags(*map, tags_by_definition(inside, tiles, tile)) == 0);
    CHECK(count_instances(*map).inside >= 10);
  }
}

TEST_CASE(
    "source 3.1.4: counting surfaces leaks through a hole; a mesh with one is refused, and where it is "
    "told") {
  TriangleMesh open = make_box({8, 8, 8}, {24, 24, 24});
  std::erase_if(open.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return open.vertices[v].z == 8; });
  });
  REQUIRE(open.triangles.size() == 10);
  // The stencil of a voxel counts the surfaces beyond it along z. Below the hole only the lid is beyond.
  const std::vector<bool> stencil = inside_by_definition(open, {32, 32, 32});
  CHECK(stencil[16 + 32 * (16 + 32 * 16)]);
  CHECK(stencil[16 + 32 * (16 + 32 * 2)]);
  CHECK(std::count(stencil.begin(), stencil.end(), true) == 16 * 16 * 24);

  const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=8,resolution=16"));
  const Result<CellObject> refused = author_cell_object(open, tile, {.repair = {Repair::kStrict}});
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == ErrorCode::kInvalidInput);
  CHECK(refused.error().id == "mesh-not-closed");
  CHECK(refused.error().message.find("4 boundary edges") != std::string::npos);
  CHECK(refused.error().message.find("first near") != std::string::npos);

  // What is closed but no manifold is no obstacle: two cubes that share an edge, and a part that lies within.
  TriangleMesh odd = make_box({8, 8, 8}, {24, 24, 24});
  append(odd, make_box({24, 24, 8}, {40, 40, 24}));
  append(odd, make_box({10, 10, 10}, {20, 20, 20}));
  const std::vector<bool> inside = inside_by_definition(odd, {48, 48, 48});
  CHECK(std::count(inside.begin(), inside.end(), true) == 2 * 16 * 16 * 16);
  MembershipReport report;
  REQUIRE(compute_membership(odd, {3, 3, 3}, tile, {}, &report).ok());
  CHECK(report.inside_voxels == 2 * 16 * 16 * 16);
  CHECK(author_cell_object(odd, tile, {}).ok());
}

TEST_CASE(
    "source 3.1.5: what touches the boundary and what has voxels on both sides are two rules with a name "
    "each") {
  // Tiles that are one cell each, and a mesh whose faces lie three quarters through the outermost voxels.
  LabelVolume full = blank({8, 8, 8});
  fill(full, {0, 0, 0}, {8, 8, 8}, 1);
  const Result<TileMap> tile = make_label_tile(full, Percolating::kCut);
  REQUIRE(tile.ok());
  REQUIRE(tile->pieces.size() == 1);
  const TriangleMesh box = make_box({0.25, 0.25, 0.25}, {23.75, 23.75, 23.75});
  const auto count = [&](MembershipRule rule) {
    const Result<MembershipMap> map = compute_membership(box, {3, 3, 3}, *tile, {.rule = rule});
    REQUIRE(map.ok());
    CHECK(map->rule == rule);
    return count_instances(*map);
  };
  // All centres are inside; but all tiles save the one in the middle touch the surface.
  CHECK(count(MembershipRule::kCentre) == InstanceCounts{27, 0, 0});
  CHECK(count(MembershipRule::kConservative) == InstanceCounts{1, 0, 26});
  // From without: no centre is inside the thin plate, which touches nine cells.
  const TriangleMesh plate = make_box({-1, -1, 9.6}, {25, 25, 10.4});
  const auto tags = [&](MembershipRule rule) {
    return count_instances(*compute_membership(plate, {3, 3, 3}, *tile, {.rule = rule}));
  };
  CHECK(tags(MembershipRule::kCentre) == InstanceCounts{0, 27, 0});
  CHECK(tags(MembershipRule::kConservative) == InstanceCounts{0, 18, 9});
}
