#include "sdk/trace/inside_pieces.h"

#include <map>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Which pieces of a tile are INSIDE, by definition: those whose instance has its home in the grid and that
/// tag. [spec 4.3]
std::vector<bool> inside_by_definition(const CellObject& object, const Index3& tile) {
  std::vector<bool> inside{false};  // empty space
  for (const Piece& p : object.tile.pieces) {
    std::uint64_t home = 0, stride = 1;
    bool in_grid = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t at = std::int64_t{tile[a]} + p.home[a];
      in_grid = in_grid && at >= 0 && at < object.grid.tiles[a];
      home += std::uint64_t(at) * stride;
      stride *= object.grid.tiles[a];
    }
    inside.push_back(in_grid && object.membership.tag(home, p.cell) == Tag::kInside);
  }
  return inside;
}

void check(const CellObject& object) {
  const InsidePieces inside(object.tile, object.membership);
  std::map<std::vector<bool>, std::uint32_t> entries;
  const std::vector<bool> none(object.tile.pieces.size() + 1);
  std::vector<bool> all(none.size(), true);
  all[0] = false;
  Index3 t{};
  for (t[2] = 0; t[2] < object.grid.tiles[2]; ++t[2])
    for (t[1] = 0; t[1] < object.grid.tiles[1]; ++t[1])
      for (t[0] = 0; t[0] < object.grid.tiles[0]; ++t[0]) {
        INFO("tile " << t[0] << ' ' << t[1] << ' ' << t[2]);
        const std::uint32_t entry = inside.entry(object.grid.tile_index(t[0], t[1], t[2]));
        const std::vector<bool> truth = inside_by_definition(object, t);
        REQUIRE((entry == InsidePieces::kNone) == (truth == none));
        REQUIRE((entry == InsidePieces::kAll) == (truth == all));
        if (entry == InsidePieces::kNone) continue;
        REQUIRE(entry <= inside.set_count());
        for (std::uint32_t id = 0; id < truth.size(); ++id) REQUIRE(inside.has(entry, id) == truth[id]);
        // Tiles with the same pieces share a set.
        REQUIRE(entries.try_emplace(truth, entry).first->second == entry);
      }
  CHECK(inside.set_count() == entries.size() + !entries.contains(all));
}

}  // namespace

TEST_CASE("pieces of INSIDE instances are those of the membership map") {
  Rng rng(1);
  for (const char* recipe : {"voronoi:cells=4,resolution=8,seed=1", "spheres:cells=3,resolution=11,seed=2",
                             "voronoi:cells=60,resolution=16,seed=3", "voronoi:cells=1,resolution=6,seed=4"})
    for (const double share : {0.0, 0.02, 0.3, 1.0}) {
      INFO(recipe << ", share " << share);
      check(random_object(rng, recipe, {5, 4, 3}, share));
    }
}

TEST_CASE("whole tiles that are INSIDE tell their neighbours, and the grid's border is beyond them") {
  Rng rng(2);
  CellObject object = random_object(rng, "voronoi:cells=6,resolution=8,seed=1", {6, 6, 6}, 0);
  for (std::uint32_t& entry : object.membership.entries) entry = std::uint32_t(Tag::kInside);
  check(object);
  for (std::uint32_t& entry : object.membership.entries)
    entry = std::uint32_t(rng.below(4) ? Tag::kInside : Tag::kIntersected);
  check(object);
}
