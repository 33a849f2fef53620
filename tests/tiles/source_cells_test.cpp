// Where the source's rules for cells and their pieces go wrong, and ours do not. [Nürnberg
// 2011, 3.1.3, 4.2, 4.3]
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/tiles/labels.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/source_rules.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

LabelVolume no_labels(const Index3& n) { return {n, std::vector<std::uint32_t>(n[0] * n[1] * n[2], 0)}; }

std::uint32_t& at(LabelVolume& volume, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return volume.labels[x + volume.resolution[0] * (y + volume.resolution[1] * z)];
}

/// One cell that winds through the tile in hairpins, a voxel thick and two apart, from the face x = 0 to an
/// end within.
LabelVolume hairpins(std::uint32_t n) {
  LabelVolume volume = no_labels({n, n, n});
  for (std::uint32_t y = 1; y + 1 < n; y += 2) {
    for (std::uint32_t x = y == 1 ? 0 : 1; x + 1 < n; ++x) at(volume, x, y, n / 2) = 1;
    if (y + 3 < n) at(volume, y % 4 == 1 ? n - 2 : 1, y + 1, n / 2) = 1;
  }
  return volume;
}

/// Marks of the voxels of a cell, each once.
template <typename Marks>
std::set<std::uint32_t> marks_of(const LabelVolume& volume, std::uint32_t label, Marks marks) {
  std::set<std::uint32_t> found;
  for (std::size_t i = 0; i < volume.labels.size(); ++i)
    if (volume.labels[i] == label) found.insert(marks(i));
  return found;
}

/// A cell that goes along x around the tile, so often; each time it ends 3 voxels higher, where its next
/// round begins.
LabelVolume winding_rounds(std::uint32_t rounds) {
  LabelVolume volume = no_labels({8, 3 * rounds + 2, 8});
  for (std::uint32_t round = 0; round < rounds; ++round)
    for (std::uint32_t x = 0; x < 8; ++x) at(volume, x, 3 * round + (x < 4 ? 0 : x - 4), 2) = 1;
  return volume;
}

/// Whether a flood of one label over the repeated volume meets a voxel in more than one tile.
bool has_no_end(const LabelVolume& volume, std::uint32_t label) {
  using Position = std::array<std::int64_t, 3>;
  const Index3& n = volume.resolution;
  const auto start = std::find(volume.labels.begin(), volume.labels.end(), label);
  if (start == volume.labels.end()) return false;
  const std::int64_t i = start - volume.labels.begin();
  std::map<std::size_t, Position> tile_of;  // voxel of the volume -> tile in which it was met
  std::vector<Position> queue{{i % n[0], i / n[0] % n[1], i / n[0] / n[1]}};
  tile_of[std::size_t(i)] = {};
  while (!queue.empty()) {
    const Position p = queue.back();
    queue.pop_back();
    for (int d = 0; d < 27; ++d) {
      const Position q{p[0] + d % 3 - 1, p[1] + d / 3 % 3 - 1, p[2] + d / 9 - 1};
      Position tile{}, v{};
      for (std::size_t a = 0; a < 3; ++a) {
        v[a] = (q[a] % n[a] + n[a]) % n[a];
        tile[a] = (q[a] - v[a]) / n[a];
      }
      const std::size_t k = std::size_t(v[0] + n[0] * (v[1] + n[1] * v[2]));
      if (volume.labels[k] != label) continue;
      const auto [known, added] = tile_of.emplace(k, tile);
      if (added) queue.push_back(q);
      if (known->second != tile) return true;
    }
  }
  return false;
}

LabelVolume cells_of(const TileMap& tile) {
  LabelVolume volume = no_labels(tile.resolution);
  for (std::uint64_t i = 0; i < tile.voxel_count(); ++i)
    if (const std::uint32_t id = tile.id(i)) volume.labels[i] = tile.pieces[id - 1].cell;
  return volume;
}

}  // namespace

TEST_CASE(
    "source 4.2: N passes over the neighbours leave a winding cell in several parts, union-find does not") {
  for (const std::uint32_t n : {10u, 12u, 16u}) {
    const LabelVolume volume = hairpins(n);
    const auto parts = [&](std::uint32_t passes) {
      const std::vector<std::uint8_t> codes = split_cells_by_passes(volume.resolution, volume.labels, passes);
      return marks_of(volume, 1, [&](std::size_t i) { return codes[i]; }).size();
    };
    // "The algorithm needs N passes to assure correct results": the far end has not yet heard of the face.
    CHECK(parts(n) == 2);
    CHECK(parts(n * n) == 1);
    const Result<TileMap> tile = make_label_tile(volume, Percolating::kRefuse);
    REQUIRE(tile.ok());
    CHECK(tile->cell_count == 1);
    CHECK(tile->pieces.size() == 1);
    CHECK(marks_of(volume, 1, [&](std::size_t i) { return tile->id(i); }) == std::set<std::uint32_t>{1});
  }
  // A short cell, on which the source's passes are enough: the model itself is sound.
  LabelVolume bar = no_labels({8, 8, 8});
  for (std::uint32_t x = 0; x < 8; ++x) at(bar, x, 4, 4) = 1;
  const std::vector<std::uint8_t> codes = split_cells_by_passes(bar.resolution, bar.labels, 8);
  CHECK(marks_of(bar, 1, [&](std::size_t i) { return codes[i]; }) == std::set<std::uint32_t>{3});
}

TEST_CASE("source 4.2-4.3: eight slots a cell, the second range one short, are too few; pieces are counted") {
  // The first cell's indices are 1 to 8, the next one's "9 to 15, and so on".
  const auto last_slot = [](std::uint32_t cell) { return cell == 1 ? 8u : 8u + 7 * (cell - 1); };
  const auto first_slot = [&](std::uint32_t cell) { return cell == 1 ? 1 : last_slot(cell - 1) + 1; };
  // Cell 2 lies on the tile's corners, in eight pieces; cells 1 and 3 within.
  LabelVolume volume = no_labels({8, 8, 8});
  at(volume, 3, 3, 3) = 1;
  at(volume, 5, 5, 5) = 3;
  for (int c = 0; c < 8; ++c) at(volume, c & 1 ? 7 : 0, c & 2 ? 7 : 0, c & 4 ? 7 : 0) = 2;
  const Result<TileMap> corners = make_label_tile(volume, Percolating::kRefuse);
  REQUIRE(corners.ok());
  const std::set<std::uint32_t> ids = marks_of(volume, 2, [&](std::size_t i) { return corners->id(i); });
  CHECK(ids.size() == 8);
  CHECK(first_slot(2) + ids.size() - 1 > last_slot(2));
  CHECK(first_slot(2) + ids.size() - 1 == first_slot(3));  // the eighth piece has the third cell's slot
  CHECK_FALSE(ids.contains(corners->id(corners->voxel_index(5, 5, 5))));

  // A cell of more than eight pieces: the source knows no ninth.
  const Result<TileMap> winding = make_label_tile(winding_rounds(12), Percolating::kRefuse);
  REQUIRE(winding.ok());
  CHECK(winding->cell_count == 1);
  CHECK(winding->pieces.size() == 12);
  const LabelVolume rounds = winding_rounds(12);
  CHECK(marks_of(rounds, 1, [&](std::size_t i) { return winding->id(i); }).size() == 12);

  // More than eight cells, of which 64 slots hold no more.
  const Result<TileMap> many = make_tile(*parse_recipe("voronoi:cells=1000,resolution=40"));
  REQUIRE(many.ok());
  CHECK(many->cell_count == 1000);
  std::set<std::uint32_t> used;
  for (std::uint64_t i = 0; i < many->voxel_count(); ++i) used.insert(many->id(i));
  CHECK(used.size() == many->pieces.size());  // each piece has voxels of its own; there is no empty space
}

TEST_CASE("source 4.3: pieces of one cell with one face code are told apart") {
  // Every round goes from the face x = 0 to the opposite one, so all have face code 3, but each is of another
  // instance of the cell.
  const LabelVolume volume = winding_rounds(4);
  const Result<TileMap> tile = make_label_tile(volume, Percolating::kRefuse);
  REQUIRE(tile.ok());
  const std::vector<std::uint8_t> codes = split_cells_by_passes(volume.resolution, volume.labels, 64);
  const auto slot = [&](std::size_t i) { return 8 * (volume.labels[i] - 1) + codes[i]; };
  CHECK(marks_of(volume, 1, slot).size() < 4);
  CHECK(marks_of(volume, 1, [&](std::size_t i) { return tile->id(i); }).size() == 4);
  std::set<std::array<std::int8_t, 3>> homes;
  for (const Piece& p : tile->pieces) homes.insert(p.home);
  CHECK(homes.size() == 4);
  // So it is with cells that generators make.
  int shared = 0;
  Rng rng(43);
  for (int k = 0; k < 100; ++k) {
    const TileMap t = *make_tile(*parse_recipe("voronoi:metric=anisotropic,cells=2,resolution=16,seed=" +
                                               std::to_string(rng.bits(30))));
    const std::vector<std::uint8_t> of_piece = face_codes(t);
    std::set<std::pair<std::uint16_t, std::uint8_t>> slots;
    for (std::size_t p = 0; p < t.pieces.size(); ++p)
      shared += !slots.emplace(t.pieces[p].cell, of_piece[p]).second;
    std::set<std::pair<std::uint16_t, std::array<std::int8_t, 3>>> places;
    for (const Piece& p : t.pieces) REQUIRE(places.emplace(p.cell, p.home).second);
  }
  CHECK(shared > 0);
}

TEST_CASE("source 3.1.3: a cell that meets its own copy has no end; ours are cut to the nearest image") {
  Rng rng(313);
  int endless = 0, tiles = 0;
  for (const std::uint32_t cells : {1u, 2u, 3u, 5u, 8u})
    for (int k = 0; k < 4; ++k) {
      const TileMap tile = *make_tile(*parse_recipe("voronoi:cells=" + std::to_string(cells) +
                                                    ",resolution=16,seed=" + std::to_string(rng.bits(30))));
      const LabelVolume volume = cells_of(tile);
      std::uint32_t without_end = 0;
      for (std::uint32_t c = 1; c <= tile.cell_count; ++c) without_end += has_no_end(volume, c);
      ++tiles;
      endless += without_end > 0;
      if (cells == 1) CHECK(without_end == 1);
      // As generated, no instance is longer than two tiles.
      for (const Piece& p : tile.pieces)
        for (const std::int8_t h : p.home) REQUIRE(std::abs(h) <= 1);
      // Imported, the same cells are found to have no end, and are cut with a warning or refused.
      TileReport report;
      const Result<TileMap> cut = make_label_tile(volume, Percolating::kCut, 1, &report);
      REQUIRE(cut.ok());
      CHECK(report.percolating_cells == without_end);
      const Result<TileMap> refused = make_label_tile(volume, Percolating::kRefuse);
      CHECK(refused.ok() == (without_end == 0));
      if (!refused) CHECK(refused.error().id == "tile-percolates");
      for (const Piece& p : cut->pieces)
        for (const std::int8_t h : p.home) REQUIRE(std::abs(h) <= 1);
    }
  CHECK(endless > tiles / 2);  // "most Voronoi tiles with few seeds"
}
