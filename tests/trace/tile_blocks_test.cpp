#include "sdk/trace/tile_blocks.h"

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

using Place = std::array<std::int64_t, 3>;
using Voxel3 = std::array<std::uint32_t, 3>;

/// Which instance a voxel of space is of, where the tile repeats without end: its cell and home; cell 0 is
/// empty space.
using Instance = std::tuple<std::uint32_t, std::int64_t, std::int64_t, std::int64_t>;

Instance instance_at(const TileMap& tile, const Place& v) {
  Place at{}, in{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t n = tile.resolution[a];
    in[a] = (v[a] % n + n) % n;
    at[a] = (v[a] - in[a]) / n;
  }
  const std::uint32_t id =
      tile.id(tile.voxel_index(std::uint32_t(in[0]), std::uint32_t(in[1]), std::uint32_t(in[2])));
  if (id == 0) return {};
  const Piece& p = tile.pieces[id - 1];
  return {p.cell, at[0] + p.home[0], at[1] + p.home[1], at[2] + p.home[2]};
}

/// What is told of a voxel to a ray of an octant: its piece, and the box up to which all is of one instance.
struct Told {
  std::uint32_t id = 0;
  Place edge{};       ///< voxels from this one on, itself included, in the octant's directions
  bool cube = false;  ///< from a brick
};

Told told_of(const TileBlocks& blocks, unsigned octant, const Voxel3& l) {
  Voxel3 m{};
  for (std::size_t a = 0; a < 3; ++a)
    m[a] = octant >> a & 1 ? l[a] : blocks.resolution(a) - 1 - l[a] + blocks.pad(a);
  const std::uint32_t record = blocks.record(octant, blocks.block_of(m));
  Told told;
  if (record & TileBlocks::kMixed) {
    const std::uint32_t v = blocks.voxel(octant, record & ~TileBlocks::kMixed, TileBlocks::voxel_of(m));
    told.id = blocks.id(v);
    for (std::size_t a = 0; a < 3; ++a) told.edge[a] = blocks.edge(v, a);
    told.cube = true;
    return told;
  }
  told.id = record & TileBlocks::kIdMask;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t end = blocks.end(a) + (octant >> a & 1 ? 0 : blocks.pad(a));
    told.edge[a] =
        std::int64_t{std::min(((m[a] >> 2) + (record >> TileBlocks::kEdgeShift)) << 2, end)} - m[a];
  }
  return told;
}

Place on(const Voxel3& l, unsigned octant, const Place& way) {
  Place v{};
  for (std::size_t a = 0; a < 3; ++a) v[a] = octant >> a & 1 ? l[a] + way[a] : l[a] - way[a];
  return v;
}

/// The edge, at most `most`, of the largest cube of one instance from a voxel on.
std::int64_t cube_by_definition(const TileMap& tile, unsigned octant, const Voxel3& l, std::int64_t most) {
  const Instance own = instance_at(tile, on(l, octant, {}));
  for (std::int64_t edge = 1; edge < most; ++edge)
    for (std::int64_t z = 0; z <= edge; ++z)
      for (std::int64_t y = 0; y <= edge; ++y)
        for (std::int64_t x = 0; x <= edge; ++x)
          if (std::max({x, y, z}) == edge && instance_at(tile, on(l, octant, {x, y, z})) != own) return edge;
  return most;
}

/// Checks `samples` voxels with an octant each, or all if they are fewer. Returns the share of boxes that are
/// longer than a voxel.
double check(const TileMap& tile, std::size_t samples) {
  const TileBlocks blocks(tile);
  Rng rng(1);
  Voxel3 l{};
  for (l[2] = 0; l[2] < tile.resolution[2]; ++l[2])
    for (l[1] = 0; l[1] < tile.resolution[1]; ++l[1])
      for (l[0] = 0; l[0] < tile.resolution[0]; ++l[0])
        REQUIRE(blocks.id_at(l) == tile.id(tile.voxel_index(l[0], l[1], l[2])));
  const std::size_t all = 8 * std::size_t(tile.voxel_count()), count = std::min(samples, all);
  std::size_t longer = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t which = count == all ? k : std::size_t(rng.next() % all);
    const unsigned octant = which % 8;
    const std::uint64_t i = which / 8;
    l = {std::uint32_t(i % tile.resolution[0]), std::uint32_t(i / tile.resolution[0] % tile.resolution[1]),
         std::uint32_t(i / tile.resolution[0] / tile.resolution[1])};
    const Told told = told_of(blocks, octant, l);
    INFO("voxel " << l[0] << ' ' << l[1] << ' ' << l[2] << ", octant " << octant << ", box " << told.edge[0]
                  << " x " << told.edge[1] << " x " << told.edge[2]);
    REQUIRE(told.id == tile.id(i));
    const Instance own = instance_at(tile, on(l, octant, {}));
    bool same = true;
    const auto look = [&](const Place& way) { same = same && instance_at(tile, on(l, octant, way)) == own; };
    if (told.edge[0] * told.edge[1] * told.edge[2] <= 4096) {
      for (std::int64_t z = 0; z < told.edge[2]; ++z)
        for (std::int64_t y = 0; y < told.edge[1]; ++y)
          for (std::int64_t x = 0; x < told.edge[0]; ++x) look({x, y, z});
    } else {
      for (unsigned corner = 0; corner < 8; ++corner)
        look({corner & 1 ? told.edge[0] - 1 : 0, corner & 2 ? told.edge[1] - 1 : 0,
              corner & 4 ? told.edge[2] - 1 : 0});
      for (int n = 0; n < 500; ++n)
        look({rng.below(std::uint32_t(told.edge[0])), rng.below(std::uint32_t(told.edge[1])),
              rng.below(std::uint32_t(told.edge[2]))});
    }
    REQUIRE(same);
    const std::int64_t least = std::min({told.edge[0], told.edge[1], told.edge[2]});
    REQUIRE(least >= 1);
    longer += std::max({told.edge[0], told.edge[1], told.edge[2]}) > 1;
    // Runs are counted up to a tile beyond the end: in tiles of 16 voxels and more cubes are the largest.
    if (told.cube && *std::min_element(tile.resolution.begin(), tile.resolution.end()) >= 16)
      REQUIRE(least == cube_by_definition(tile, octant, l, 1 << blocks.edge_bits()));
  }
  return double(longer) / double(count);
}

TileMap tile_of(const std::string& recipe) { return std::move(*make_tile(*parse_recipe(recipe))); }

/// Ids at random, in rows of the same one, of pieces made by hand.
TileMap random_tile(const Index3& resolution, std::vector<Piece> pieces, std::uint64_t seed) {
  TileMap tile;
  tile.resolution = resolution;
  tile.pieces = std::move(pieces);
  tile.id_bytes = 4;
  for (const Piece& p : tile.pieces) tile.cell_count = std::max<std::uint32_t>(tile.cell_count, p.cell);
  Rng rng(seed);
  std::uint32_t id = 0;
  for (std::uint64_t i = 0; i < tile.voxel_count(); ++i) {
    if (rng.below(4) == 0) id = rng.below(std::uint32_t(tile.pieces.size() + 1));
    for (unsigned b = 0; b < 4; ++b) tile.voxel_ids.push_back(std::uint8_t(id >> (8 * b)));
  }
  return tile;
}

/// The parts that a piece has voxels in, as rays of an octant see them.
void check_parts(const TileMap& tile) {
  const TileBlocks blocks(tile);
  for (unsigned octant = 0; octant < 8; ++octant) {
    std::vector<Bits64> parts(tile.pieces.size() + 1);
    for (std::uint64_t i = 0; i < tile.voxel_count(); ++i) {
      const std::uint64_t nx = tile.resolution[0], ny = tile.resolution[1];
      const std::uint64_t l[3] = {i % nx, i / nx % ny, i / nx / ny};
      unsigned part = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const std::uint64_t m = octant >> a & 1 ? l[a] : tile.resolution[a] - 1 - l[a] + blocks.pad(a);
        REQUIRE(m >> blocks.part_shift(a) < 4);
        part += unsigned(m >> blocks.part_shift(a)) << (2 * a);
      }
      parts[tile.id(i)] |= Bits64{1} << part;
    }
    for (std::uint32_t id = 0; id < parts.size(); ++id) {
      INFO("octant " << octant << ", piece " << id);
      REQUIRE(blocks.mirrored_parts(blocks.parts_of(id), octant) == parts[id]);
      if (octant == 7) REQUIRE(blocks.parts_of(id) == parts[id]);
    }
  }
}

}  // namespace

TEST_CASE("boxes around the voxels of a tile are of one instance, also across its end") {
  struct Case {
    const char* recipe;
    bool flat;
  };
  for (const Case& c :
       {Case{"voronoi:cells=4,resolution=8,seed=1", true}, Case{"spheres:cells=3,resolution=5,seed=2", true},
        Case{"voronoi:cells=20,resolution=7x9x5,seed=3", true},
        Case{"spheres:cells=6,resolution=13x9x11,seed=4", true},
        Case{"spheres:cells=5,resolution=16,seed=5", true},
        Case{"voronoi:cells=9,resolution=20,seed=6", true},
        Case{"spheres:cells=5,resolution=33,seed=7", false},
        Case{"voronoi:cells=3,resolution=33,seed=8", false},
        Case{"voronoi:cells=1,resolution=36,seed=9", false},
        Case{"spheres:cells=2,resolution=64,seed=10", false},
        Case{"voronoi:cells=4,resolution=40x64x33,seed=11", false},
        Case{"voronoi:cells=3,resolution=1024x4x4,seed=12", true},
        Case{"voronoi:cells=3,resolution=6x700x12,seed=13", false}}) {
    INFO(c.recipe);
    const TileMap tile = tile_of(c.recipe);
    REQUIRE(TileBlocks(tile).flat() == c.flat);
    CHECK(check(tile, 20000) > 0.5);
    check_parts(tile);
  }
}

TEST_CASE("voxels of many pieces take four bytes") {
  for (const char* recipe :
       {"voronoi:cells=150,resolution=20,seed=1", "voronoi:cells=90,resolution=34,seed=2"}) {
    INFO(recipe);
    const TileMap tile = tile_of(recipe);
    REQUIRE(tile.pieces.size() > 127);
    REQUIRE(TileBlocks(tile).voxel_shift() == 2);
    CHECK(check(tile, 20000) > 0.2);
    check_parts(tile);
  }
}

TEST_CASE("boxes in tiles made by hand") {
  // Pieces of one instance that lie where no connected cell would have them, and those of equal cells in
  // other tiles.
  const std::vector<Piece> pieces{{1, {-1, 0, 0}}, {1, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {0, -1, 1}},
                                  {2, {0, 0, 0}},  {2, {0, 1, 0}}, {3, {0, 0, 0}}, {3, {-128, 127, 0}}};
  for (const Index3& n : {Index3{4, 4, 4}, Index3{5, 4, 7}, Index3{16, 16, 17}, Index3{40, 36, 33}})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) check(random_tile(n, pieces, seed), 20000);
  // All of one piece: of an instance that is all of space in a direction, of one a tile, and empty.
  for (const Index3& n : {Index3{4, 4, 4}, Index3{33, 36, 40}, Index3{64, 64, 64}}) {
    TileMap tile = random_tile(n, {{1, {0, 0, 0}}}, 1);
    for (const std::uint8_t id : {std::uint8_t{0}, std::uint8_t{1}}) {
      for (std::size_t i = 0; i < tile.voxel_ids.size(); i += 4) tile.voxel_ids[i] = id;
      CHECK(check(tile, 20000) > 0.5);
      check_parts(tile);
    }
  }
}

TEST_CASE("a tile of more than a million pieces") {
  std::vector<Piece> pieces;
  for (std::uint32_t k = 0; k < (1u << 20) + 5; ++k)
    pieces.push_back({std::uint16_t(1 + k % 65000), {std::int8_t(k / 65000), 0, 0}});
  const TileMap tile = random_tile({20, 9, 6}, pieces, 1);
  REQUIRE(TileBlocks(tile).id_bits() == 26);
  CHECK(check(tile, 10000) > 0.05);
}
