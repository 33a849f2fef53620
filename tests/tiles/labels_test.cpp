#include "sdk/tiles/labels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <map>
#include <set>
#include <vector>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

using Place = std::array<std::int32_t, 3>;

/// Parts of a volume by flooding the plane that it repeats over: slow and obvious.
struct Part {
  std::map<Place, Place> shifts;  ///< voxel of the tile -> tile that the flood first met it in
  bool percolates = false;
};

std::uint64_t index(const LabelVolume& volume, const Place& v) {
  return std::uint64_t(v[0]) +
         volume.resolution[0] * (std::uint64_t(v[1]) + volume.resolution[1] * std::uint64_t(v[2]));
}

std::vector<Part> parts_by_flooding(const LabelVolume& volume) {
  const auto& n = volume.resolution;
  std::set<Place> seen;
  std::vector<Part> parts;
  for (std::int32_t z = 0; z < std::int32_t(n[2]); ++z)
    for (std::int32_t y = 0; y < std::int32_t(n[1]); ++y)
      for (std::int32_t x = 0; x < std::int32_t(n[0]); ++x) {
        const Place start{x, y, z};
        const std::uint32_t label = volume.labels[index(volume, start)];
        if (label == 0 || seen.contains(start)) continue;
        Part part;
        std::deque<Place> queue{start};
        part.shifts[start] = {};
        seen.insert(start);
        while (!queue.empty()) {
          const Place v = queue.front(), s = part.shifts[v];
          queue.pop_front();
          for (int d = 0; d < 27; ++d) {
            Place w{v[0] + d % 3 - 1, v[1] + d / 3 % 3 - 1, v[2] + d / 9 - 1}, t = s;
            for (std::size_t a = 0; a < 3; ++a) {
              const std::int32_t edge = std::int32_t(n[a]);
              if (w[a] < 0) w[a] += edge, --t[a];
              if (w[a] >= edge) w[a] -= edge, ++t[a];
            }
            if (volume.labels[index(volume, w)] != label) continue;
            if (const auto found = part.shifts.find(w); found == part.shifts.end()) {
              part.shifts[w] = t;
              seen.insert(w);
              queue.push_back(w);
            } else if (found->second != t) {
              part.percolates = true;
            }
          }
        }
        parts.push_back(std::move(part));
      }
  return parts;
}

const Piece* piece_at(const TileMap& tile, const Place& v) {
  const std::uint32_t id =
      tile.id(tile.voxel_index(std::uint32_t(v[0]), std::uint32_t(v[1]), std::uint32_t(v[2])));
  return id ? &tile.pieces[id - 1] : nullptr;
}

/// The home tile of the instance that a voxel is of, if the voxel lies in tile `shift`.
Place home_of(const Piece& piece, const Place& shift) {
  return {shift[0] + piece.home[0], shift[1] + piece.home[1], shift[2] + piece.home[2]};
}

LabelVolume blank(const Index3& n) { return {n, std::vector<std::uint32_t>(n[0] * n[1] * n[2], 0)}; }

LabelVolume labels_of(const TileMap& tile) {
  LabelVolume volume = blank(tile.resolution);
  for (std::uint64_t i = 0; i < tile.voxel_count(); ++i)
    if (const std::uint32_t id = tile.id(i)) volume.labels[i] = tile.pieces[id - 1].cell;
  return volume;
}

/// A cell that goes along x around the tile, so often; each time it ends 3 voxels higher, where its next
/// round begins. Only there do rounds touch.
LabelVolume thread(std::int32_t rounds) {
  LabelVolume volume = blank({8, std::uint32_t(3 * rounds + 2), 8});
  for (std::int32_t round = 0; round < rounds; ++round)
    for (std::int32_t x = 0; x < 8; ++x)
      volume.labels[index(volume, {x, 3 * round + std::max(0, x - 4), 2})] = 5;
  return volume;
}

}  // namespace

TEST_CASE("cells of a label volume are what a flood of the repeated volume reaches") {
  Rng rng(20240901);
  int percolating = 0, bounded = 0, crossing = 0;
  for (int round = 0; round < 300; ++round) {
    LabelVolume volume = blank({4 + rng.below(6), 4 + rng.below(4), 4 + rng.below(5)});
    const std::uint32_t labels = 1 + rng.below(4), empty = rng.below(12);
    for (std::uint32_t& label : volume.labels)
      label = rng.below(12) < empty ? 0 : 7 * (1 + rng.below(labels));
    const std::vector<Part> parts = parts_by_flooding(volume);
    TileReport report;
    const Result<TileMap> tile = make_label_tile(volume, Percolating::kCut, 2, &report);
    if (parts.empty()) {
      REQUIRE(!tile);
      continue;
    }
    REQUIRE(tile);
    REQUIRE(tile->cell_count == parts.size());
    std::set<std::uint32_t> cells;
    std::uint32_t cut = 0;
    for (const Part& part : parts) {
      const Piece& first = *piece_at(*tile, part.shifts.begin()->first);
      REQUIRE(cells.insert(first.cell).second);
      for (const auto& [voxel, shift] : part.shifts) {
        const Piece* piece = piece_at(*tile, voxel);
        REQUIRE(piece);
        REQUIRE(piece->cell == first.cell);
        if (part.percolates) continue;
        REQUIRE(home_of(*piece, shift) == home_of(first, part.shifts.begin()->second));
        crossing += shift != Place{};
      }
      cut += part.percolates;
      (part.percolates ? percolating : bounded) += 1;
    }
    REQUIRE(report.percolating_cells == cut);
    for (std::uint64_t i = 0; i < volume.voxel_count(); ++i)
      REQUIRE((tile->id(i) == 0) == (volume.labels[i] == 0));
    const Result<TileMap> refused = make_label_tile(volume, Percolating::kRefuse);
    REQUIRE(refused.ok() == (cut == 0));
    if (cut) REQUIRE(refused.error().id == "tile-percolates");
  }
  CAPTURE(percolating, bounded, crossing);
  CHECK(std::min({percolating, bounded, crossing}) > 250);
}

TEST_CASE("a generated tile comes back whole from its labels") {
  for (const char* recipe : {"voronoi:cells=40,resolution=32,seed=3", "spheres:cells=9,resolution=24x32x40",
                             "ellipsoids:cells=5,resolution=48", "bricks:cells=8,resolution=40",
                             "voronoi:cells=300,resolution=40"}) {
    CAPTURE(recipe);
    const Result<TileMap> tile = make_tile(*parse_recipe(recipe));
    REQUIRE(tile);
    for (const unsigned threads : {1u, 3u}) {
      const Result<TileMap> back = make_label_tile(labels_of(*tile), Percolating::kRefuse, threads);
      REQUIRE(back);
      CHECK(*back == *tile);
    }
  }
}

TEST_CASE("a cell that winds through many tiles is one cell") {
  const Result<TileMap> tile = make_label_tile(thread(5), Percolating::kRefuse);
  REQUIRE(tile);
  CHECK(tile->cell_count == 1);
  REQUIRE(tile->pieces.size() == 5);
  for (std::int32_t round = 0; round < 5; ++round)
    CHECK(piece_at(*tile, {0, 3 * round, 2})->home == std::array<std::int8_t, 3>{std::int8_t(-round), 0, 0});
}

TEST_CASE("a cell that meets its own copy is cut to the nearest image of its centroid") {
  // A bar along x that fills the row, thicker at x = 6.
  LabelVolume volume = blank({9, 8, 8});
  for (std::uint32_t x = 0; x < 9; ++x) volume.labels[x + 9 * (4 + 8 * 4)] = 1;
  for (std::uint32_t y = 2; y < 7; ++y)
    for (std::uint32_t z = 2; z < 7; ++z) volume.labels[6 + 9 * (y + 8 * z)] = 1;
  // 33 voxels, of which 24 are at x = 6 besides the bar: (36 + 24·6) / 33 = 5.45; voxels within 4.5 of it are
  // 1…9, so x = 0 goes to the copy on the right.
  TileReport report;
  const Result<TileMap> tile = make_label_tile(volume, Percolating::kCut, 1, &report);
  REQUIRE(tile);
  CHECK(report.percolating_cells == 1);
  REQUIRE(tile->pieces.size() == 2);
  const Piece &left = *piece_at(*tile, {0, 4, 4}), &right = *piece_at(*tile, {1, 4, 4});
  CHECK(right.home == std::array<std::int8_t, 3>{0, 0, 0});
  CHECK(left.home == std::array<std::int8_t, 3>{-1, 0, 0});
  for (std::int32_t x = 1; x < 9; ++x) CHECK(piece_at(*tile, {x, 4, 4}) == &right);

  // A tile that is all one label: one cell, of one piece, as its centroid is the tile's centre.
  volume.labels.assign(volume.labels.size(), 3);
  const Result<TileMap> full = make_label_tile(volume, Percolating::kCut);
  REQUIRE(full);
  CHECK(full->pieces.size() == 1);
}

TEST_CASE("label volumes that make no tile are refused with a reason") {
  const auto code = [](const LabelVolume& volume, const Progress* progress = nullptr) {
    const Result<TileMap> tile = make_label_tile(volume, Percolating::kCut, 1, nullptr, progress);
    REQUIRE(!tile);
    CHECK(!tile.error().message.empty());
    return tile.error().code;
  };
  CHECK(code(blank({8, 8, 8})) == ErrorCode::kInvalidInput);
  CHECK(code(blank({3, 8, 8})) == ErrorCode::kInvalidInput);
  CHECK(code(blank({8, 1025, 8})) == ErrorCode::kInvalidInput);
  // Single voxels with gaps between: 41³ parts.
  LabelVolume dust = blank({82, 82, 82});
  for (std::int32_t z = 0; z < 82; z += 2)
    for (std::int32_t y = 0; y < 82; y += 2)
      for (std::int32_t x = 0; x < 82; x += 2) dust.labels[index(dust, {x, y, z})] = 1;
  CHECK(code(dust) == ErrorCode::kLimit);
  CHECK(make_label_tile(thread(101), Percolating::kRefuse).ok());
  CHECK(code(thread(102)) == ErrorCode::kLimit);
  std::atomic<bool> cancel = true;
  const Progress progress{{}, &cancel};
  LabelVolume one = blank({8, 8, 8});
  one.labels[0] = 1;
  CHECK(code(one, &progress) == ErrorCode::kCancelled);
}
