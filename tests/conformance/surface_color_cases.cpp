#include <algorithm>
#include <functional>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// SCOL, which version 1.1 brought. [spec 4.11]
namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::size_t kBricksAt = 64;
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

using Has = std::function<bool(std::size_t brick, std::size_t voxel)>;
bool all(std::size_t, std::size_t) { return true; }
bool every_second(std::size_t brick, std::size_t v) { return (v + brick) % 2 == 0; }

/// Bricks in some of `tiles` tiles, with colors where `has` says.
SurfaceColors colors_in(std::uint32_t tiles, const std::vector<std::uint32_t>& bricks,
                        const Index3& resolution, const Has& has) {
  SurfaceColors map;
  map.resolution = resolution;
  map.entries.assign(tiles, SurfaceColors::kNoBrick);
  for (const std::uint32_t tile : bricks) {
    const std::size_t brick = map.first.size(), at = map.masks.size();
    map.entries.at(tile) = std::uint32_t(brick);
    map.first.push_back(std::uint32_t(map.colors.size()));
    map.masks.resize(at + map.mask_bytes());
    for (std::size_t v = 0; v < map.voxels_per_brick(); ++v) {
      if (!has(brick, v)) continue;
      map.masks[at + v / 8] = std::uint8_t(map.masks[at + v / 8] | 1u << v % 8);
      map.colors.push_back({std::uint8_t(97 * v), std::uint8_t(255 - v), std::uint8_t(10 + 50 * brick)});
    }
  }
  return map;
}

TestFile with_colors(const CellObject& object, const SurfaceColors& map) {
  CellObject colored = object;
  colored.surface_colors = map;
  TestFile parts = TestFile::of(colored);
  parts.chunks.pop_back();  // the empty TEXT
  return parts;
}

/// tiny() with bricks of 2 × 3 × 2 in both of its tiles, six colors each. SCOL has header, bricks, ranks,
/// masks of two bytes each at 192, and differences from 256 on.
TestFile usual() { return with_colors(tiny_object(), colors_in(2, {0, 1}, {2, 3, 2}, every_second)); }
constexpr std::size_t kRanksAt = 128, kMasksAt = 192, kColorsAt = 256, kBytes = 256 + 12 * 3;

Bytes packed_colors(TestFile parts) {
  for (TestChunk& c : parts.chunks) pack(c);
  return parts.build();
}

void add_surface_color_field_cases(CaseList& cases) {
  const TestFile parts = usual();
  cases.valid("scol/two-bricks", "4.11", parts.build());
  add_chunk_header_cases(cases, parts, kSurfaceColorChunk, 24);
  add_stated_error_cases(cases, parts, kSurfaceColorChunk, 12, "4.11");
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = kAxes[a];
    for (const std::uint32_t r : {0u, 5u, 33u, 65537u, 0x80000001u, 0xffffffffu})
      cases.fault("scol-resolution/" + axis + "-" + to_string(r), with(parts, kSurfaceColorChunk, 4 * a, r));
    // All else is as such a resolution wants.
    Index3 tile = {8, 8, 8}, resolution = {2, 2, 2};
    tile[a] = 4;
    for (const std::uint32_t r : {4u, 5u}) {
      resolution[a] = r;
      const Bytes file =
          with_colors(solid_object(tile, {1, 1, 1}), colors_in(1, {0}, resolution, all)).build();
      if (r == 4)
        cases.valid("scol/as-fine-as-the-tile-along-" + axis, "4.11", file);
      else
        cases.fault("scol-resolution/" + axis + "-above-the-tile", file);
    }
    tile = {4, 4, 4}, resolution = {1, 1, 1};
    tile[a] = 40;
    for (const std::uint32_t r : {32u, 33u}) {
      resolution[a] = r;
      const Bytes file =
          with_colors(solid_object(tile, {1, 1, 1}), colors_in(1, {0}, resolution, every_second)).build();
      if (r == 32)
        cases.valid("scol/32-along-" + axis, "4.11", file);
      else
        cases.fault("scol-resolution/" + axis + "-really-33", file);
    }
  }
  for (std::size_t bytes = 64; bytes < kBytes; bytes += bytes + 8 < kColorsAt ? 29 : 5)
    cases.fault("payload-truncated/scol-" + to_string(bytes), with_size(parts, kSurfaceColorChunk, bytes));
  cases.fault("payload-truncated/scol-all-but-a-byte", with_size(parts, kSurfaceColorChunk, kBytes - 1));
  for (const std::size_t more : {1u, 2u, 3u, 64u})
    cases.fault("payload-trailing/scol-" + to_string(kBytes + more),
                with_size(parts, kSurfaceColorChunk, kBytes + more));
  cases.faults("payload-trailing/scol-fewer-colors", with(parts, kSurfaceColorChunk, 20, 11));
  for (const std::uint32_t more : {13u, 0x80000000u, 0xffffffffu})
    cases.fault("payload-truncated/scol-" + to_string(more) + "-colors",
                with(parts, kSurfaceColorChunk, 20, more));
  for (const std::uint32_t more : {33u, 0x80000000u, 0xffffffffu})
    cases.fault("payload-truncated/scol-" + to_string(more) + "-bricks",
                with(parts, kSurfaceColorChunk, 16, more));
  for (const std::size_t at :
       {kBricksAt + 1, kRanksAt - 1, kRanksAt + 8, kMasksAt - 1, kMasksAt + 4, kColorsAt - 1})
    cases.fault("payload-padding/scol-" + to_string(at), with(parts, kSurfaceColorChunk, at, 1, 1));
  TestFile critical = parts;
  critical.chunk(kSurfaceColorChunk).flags = 1;
  cases.fault("chunk-criticality/scol", critical.build());
  // In a file of 1.0 the type is unknown, and what the chunk holds is nobody's business.
  TestFile older = parts;
  older.minor = 0;
  cases.valid("scol/in-1-0", "5", older.build(), "chunk-unknown-skippable");
  cases.valid("scol/in-1-0-of-another-size", "5", with_size(older, kSurfaceColorChunk, 3),
              "chunk-unknown-skippable");
  older.chunk(kSurfaceColorChunk).flags = 1;
  cases.fault("chunk-unknown-critical/scol-in-1-0", older.build());
}

void add_brick_cases(CaseList& cases) {
  const TestFile parts = usual();
  for (const unsigned bits : {0b01u, 0b10u})
    cases.fault("scol-brick-count/of-bits-" + to_string(bits),
                with(parts, kSurfaceColorChunk, kBricksAt, bits, 1));
  // Counts with which the size stays the same: masks end before the next multiple of 64.
  for (const std::uint32_t count : {1u, 3u, 32u})
    cases.fault("scol-brick-count/stated-" + to_string(count), with(parts, kSurfaceColorChunk, 16, count));
  cases.fault("scol-brick-count/none", edited(parts, kSurfaceColorChunk, [](Bytes& scol) {
                put(scol, 16, 0, 8);
                put(scol, kBricksAt, 0, 1);
                scol.resize(kMasksAt);
              }));
  cases.fault("scol-brick-count/none-in-the-bits",
              edited(parts, kSurfaceColorChunk, [](Bytes& scol) { put(scol, kBricksAt, 0, 1); }));
  for (unsigned bit = 2; bit < 8; ++bit)
    cases.fault("scol-unused-bits/tile-" + to_string(bit),
                with_bit(parts, kSurfaceColorChunk, kBricksAt, bit));
  for (unsigned bit = 12; bit < 16; ++bit) {
    cases.fault("scol-unused-bits/first-brick-" + to_string(bit),
                with_bit(parts, kSurfaceColorChunk, kMasksAt, bit));
    cases.fault("scol-unused-bits/second-brick-" + to_string(bit),
                with_bit(parts, kSurfaceColorChunk, kMasksAt + 2, bit));
  }
  // An unused bit instead of a color, and one that is counted.
  cases.fault("scol-unused-bits/counted", edited(parts, kSurfaceColorChunk, [](Bytes& scol) {
                put(scol, kMasksAt + 3, get(scol, kMasksAt + 3, 1) | 0x80, 1);
                put(scol, kMasksAt + 2, get(scol, kMasksAt + 2, 1) | 0x01, 1);
                put(scol, 20, 13);
                scol.resize(kBytes + 3);
              }));
  // As many bricks, and colors, as bits are set.
  cases.faults("scol-unused-bits/with-a-brick", with(parts, kSurfaceColorChunk, kBricksAt, 0b101, 1));
  cases.faults("scol-unused-bits/with-a-color", edited(parts, kSurfaceColorChunk, [](Bytes& scol) {
                 put(scol, kMasksAt + 3, get(scol, kMasksAt + 3, 1) | 0x80, 1);
                 put(scol, 20, 13);
                 scol.resize(kBytes + 3);
               }));
  for (unsigned brick = 0; brick < 2; ++brick) {
    cases.fault("scol-empty-brick/" + to_string(brick), edited(parts, kSurfaceColorChunk, [&](Bytes& scol) {
                  put(scol, kMasksAt, 0, 4);
                  put(scol, kMasksAt + 2 * (1 - brick), 0xfff, 2);
                }));
  }
  // All of the differences are there, for one more or one less than the masks have.
  cases.fault("scol-color-count/one-more", edited(parts, kSurfaceColorChunk, [](Bytes& scol) {
                put(scol, 20, 13);
                scol.resize(kBytes + 3);
              }));
  cases.fault("scol-color-count/one-less", edited(parts, kSurfaceColorChunk, [](Bytes& scol) {
                put(scol, 20, 11);
                scol.resize(kBytes - 3);
              }));
  cases.fault("scol-color-count/none", edited(parts, kSurfaceColorChunk, [](Bytes& scol) {
                put(scol, 20, 0);
                scol.resize(kColorsAt);
              }));
  cases.fault("scol-color-count/a-bit-more", with_bit(parts, kSurfaceColorChunk, kMasksAt, 1));
  cases.fault("scol-color-count/a-bit-less", with_bit(parts, kSurfaceColorChunk, kMasksAt + 2, 1));
  for (unsigned bit = 0; bit < 32; bit += 3) {
    cases.fault("scol-rank/bricks-bit-" + to_string(bit), with_bit(parts, kSurfaceColorChunk, kRanksAt, bit));
    cases.fault("scol-rank/colors-bit-" + to_string(bit),
                with_bit(parts, kSurfaceColorChunk, kRanksAt + 4, bit));
  }
  const auto scol_of = [](std::uint32_t tiles, const std::vector<std::uint32_t>& bricks,
                          const Index3& resolution = {1, 2, 1}) {
    return with_colors(row_object(tiles, {}), colors_in(tiles, bricks, resolution, all));
  };
  for (const std::uint32_t tiles : {1u, 7u, 8u, 9u, 16u, 511u, 512u, 513u}) {
    const TestFile row = scol_of(tiles, {tiles - 1});
    cases.valid("scol/last-of-" + to_string(tiles) + "-tiles", "4.11", row.build());
    for (unsigned bit = tiles % 8; bit % 8 != 0; ++bit)
      cases.fault("scol-unused-bits/" + to_string(tiles) + "-tiles-bit-" + to_string(bit),
                  with_bit(row, kSurfaceColorChunk, kBricksAt + tiles / 8, bit));
  }
  for (const Index3& r : {Index3{1, 1, 1}, Index3{2, 2, 2}, Index3{3, 1, 3}, Index3{4, 4, 4}})
    cases.valid("scol/" + to_string(r[0]) + "x" + to_string(r[1]) + "x" + to_string(r[2]), "4.11",
                scol_of(3, {0, 2}, r).build());
}

/// Pages of 4096 tiles, stored as frames.
void add_surface_color_page_cases(CaseList& cases) {
  constexpr std::uint32_t kPageTiles = 4096;
  for (const std::uint32_t tiles : {kPageTiles - 1, kPageTiles, kPageTiles + 1, 2 * kPageTiles + 1}) {
    std::vector<std::uint32_t> bricks = {5, kPageTiles - 2};
    for (const std::uint32_t t : {kPageTiles - 1, kPageTiles, tiles - 1})
      if (t < tiles && t > bricks.back()) bricks.push_back(t);
    const TestFile parts =
        with_colors(row_object(tiles, {}), colors_in(tiles, bricks, {2, 2, 1}, every_second));
    const std::string name = to_string(tiles);
    cases.valid("scol/pages-" + name + "-tiles", "4.11", packed_colors(parts));
    const std::size_t ranks = 64 + ((tiles + 7) / 8 + 63) / 64 * 64;
    const Bytes scol = parts.chunks.back().stored;
    for (std::size_t page = 1; page < (tiles + kPageTiles - 1) / kPageTiles; ++page) {
      for (const std::size_t at : {ranks + 8 * page, ranks + 8 * page + 4}) {
        const auto with_rank = [&](std::uint32_t rank) {
          TestFile other = parts;
          Bytes changed = scol;
          put(changed, at, rank);
          other.set_payload(kSurfaceColorChunk, changed);
          return packed_colors(other);
        };
        const std::uint32_t rank = std::uint32_t(get(scol, at));
        const std::string where =
            "scol-rank/" + name + "-tiles-page-" + to_string(page) + (at % 8 == 0 ? "-bricks" : "-colors");
        cases.fault(where + "-high", with_rank(rank + 1));
        cases.fault(where + "-low", with_rank(rank - 1));
        cases.fault(where + "-zero", with_rank(0));
        cases.fault(where + "-sign-bit", with_rank(rank | 0x80000000));
        cases.fault(where + "-big-endian", with_rank(rank << 24));
      }
    }
  }
}

/// What colors are predicted from: who does it otherwise reads other colors.
void add_prediction_cases(CaseList& cases) {
  const auto only = [](std::vector<std::size_t> voxels) -> Has {
    return [voxels](std::size_t, std::size_t v) {
      return std::find(voxels.begin(), voxels.end(), v) != voxels.end();
    };
  };
  // In bricks of 4 × 4 × 4: voxel x + 4y + 16z.
  const std::vector<std::pair<const char*, std::vector<std::size_t>>> patterns = {
      {"alone", {21}},
      {"before-in-x", {2, 20, 21}},
      {"before-in-y", {3, 17, 18, 21}},
      {"before-in-z", {5, 18, 20 - 1, 21}},
      {"before-in-x-and-y", {16, 17, 20, 21}},
      {"before-in-x-and-z", {5, 18, 20, 21}},
      {"before-in-y-and-z", {5, 17, 19, 21}},
      {"before-in-all", {5, 17, 19, 20, 21}},
      {"none-but-diagonal", {0, 4, 16, 21}},
      {"not-around-rows", {0, 3, 4}},
      {"not-around-slices", {0, 12, 16}},
      {"not-after", {21, 22, 25, 37}},
      {"first-and-last", {0, 63}},
  };
  for (const auto& [name, voxels] : patterns)
    cases.valid("scol/predicted-" + std::string(name), "4.11",
                with_colors(tiny_object(), colors_in(2, {0, 1}, {4, 4, 4}, only(voxels))).build());
  cases.valid("scol/predicted-by-many", "4.11",
              with_colors(tiny_object(),
                          colors_in(2, {0, 1}, {4, 3, 4},
                                    [](std::size_t brick, std::size_t v) { return (v * 7 + brick) % 5 < 3; }))
                  .build());
  // Channels wrap around.
  SurfaceColors map = colors_in(2, {0, 1}, {4, 1, 1}, all);
  for (std::size_t i = 0; i < map.colors.size(); ++i)
    map.colors[i] = {std::uint8_t(i % 2 * 255), std::uint8_t(255 - i % 2 * 255), std::uint8_t(i * 85)};
  cases.valid("scol/predicted-far-off", "4.11", with_colors(tiny_object(), map).build());
}

void add_object_cases(CaseList& cases) {
  // The largest brick.
  Index3 most = {32, 32, 32};
  CellObject large = solid_object(most, {1, 1, 1});
  SurfaceColors map = colors_in(1, {0}, most, all);
  std::fill(map.colors.begin(), map.colors.end(), Rgb8{200, 100, 50});
  cases.valid("scol/32x32x32", "4.11", packed_colors(with_colors(large, map)));
  // Of a tile whose resolution is no multiple.
  cases.valid("scol/31-of-33", "4.11",
              packed_colors(with_colors(solid_object({33, 5, 4}, {2, 1, 1}),
                                        colors_in(2, {1}, {31, 3, 3}, every_second))));
  // With the other colors, and normals that are none.
  CellObject object = tiny_object();
  object.color = ColorMap{{1, 1, 2}, {{1, 2, 3}, {200, 100, 255}}, 0.5f};
  object.cell_colors = ColorList{{{255, 0, 128}, {4, 5, 6}}, 0};
  object.instance_colors = ColorList{{{7, 8, 9}, {10, 11, 12}, {13, 14, 15}}, 1.5f};
  cases.valid("scol/with-all-colors", "4.5",
              with_colors(object, colors_in(2, {0}, {2, 2, 2}, every_second)).build());
  // Where nothing is INSIDE: a writer should not, and may.
  CellObject hollow = tiny_object();
  hollow.membership.entries = {1, 0};
  hollow.membership.blocks.clear();
  cases.valid("scol/where-nothing-is-inside", "4.11",
              with_colors(hollow, colors_in(2, {1}, {1, 1, 1}, all)).build());
  TestFile split_up = with_colors(large, colors_in(1, {0}, {16, 16, 16}, all));
  split_by_hand(split_up.chunk(kSurfaceColorChunk), 4096, true);
  pack(split_up.chunk(kTileChunk));
  cases.valid("scol/in-blocks", "4.11", split_up.build());
  // Before the chunks that it needs.
  TestFile early = usual();
  std::rotate(early.chunks.begin(), early.chunks.end() - 1, early.chunks.end());
  cases.valid("scol/before-the-grid", "4.11", early.build());
}

}  // namespace

void add_surface_color_cases(CaseList& cases) {
  add_surface_color_field_cases(cases);
  add_brick_cases(cases);
  add_surface_color_page_cases(cases);
  add_prediction_cases(cases);
  add_object_cases(cases);
}

}  // namespace mesocell::test
