#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/hash.h"
#include "format/loader/mesocell_loader.h"
#include "tests/format/sole_fault.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

/// SCOL. [spec 4.11]
namespace {

/// The walk-through's object in a row of tiles, all INSIDE, with a brick of this resolution in each tile of
/// `bricks`, which has a color in every color voxel that `has(brick, v)` says.
CellObject row_of(std::uint32_t tiles, const std::vector<std::uint32_t>& bricks, const Index3& resolution,
                  const std::function<bool(std::size_t, std::size_t)>& has) {
  CellObject object = walkthrough_object();
  object.grid.tiles = object.membership.tiles = {tiles, 1, 1};
  object.membership.entries.assign(tiles, 1);
  object.membership.blocks.clear();
  SurfaceColors& map = object.surface_colors.emplace();
  map.resolution = resolution;
  map.entries.assign(tiles, SurfaceColors::kNoBrick);
  for (const std::uint32_t tile : bricks) {
    const std::size_t brick = map.first.size(), at = map.masks.size();
    map.entries[tile] = std::uint32_t(brick);
    map.first.push_back(std::uint32_t(map.colors.size()));
    map.masks.resize(at + map.mask_bytes());
    for (std::size_t v = 0; v < map.voxels_per_brick(); ++v) {
      if (!has(brick, v)) continue;
      map.masks[at + v / 8] = std::uint8_t(map.masks[at + v / 8] | 1u << v % 8);
      map.colors.push_back({std::uint8_t(10 * v), std::uint8_t(200 - v), std::uint8_t(7 * brick)});
    }
  }
  return object;
}

/// Two tiles with a brick of 2 × 3 × 2 color voxels each, of which every second has a color, and one without.
CellObject small_object() {
  return row_of(3, {0, 2}, {2, 3, 2}, [](std::size_t brick, std::size_t v) { return v % 2 == brick; });
}
/// Its parts in SCOL.
constexpr std::size_t kBricksAt = 64, kRanksAt = 128, kMasksAt = 192, kColorsAt = 256, kBytes = 256 + 12 * 3;

/// Bytes of SCOL in `object` changed.
Bytes edited(const CellObject& object, const std::function<void(Bytes&)>& edit) {
  TestFile parts = TestFile::of(object);
  Bytes payload = parts.payload(kSurfaceColorChunk);
  edit(payload);
  parts.set_payload(kSurfaceColorChunk, payload);
  return parts.build();
}
Bytes with(std::size_t at, std::uint64_t value, unsigned bytes = 4) {
  return edited(small_object(), [&](Bytes& scol) { put(scol, at, value, bytes); });
}

/// The differences as the spec has them, color by color.
Bytes differences_by_the_text(const SurfaceColors& map) {
  Bytes bytes;
  const Index3& r = map.resolution;
  for (std::size_t tile = 0; tile < map.entries.size(); ++tile) {
    if (map.entries[tile] == SurfaceColors::kNoBrick) continue;
    const auto at = [&](int x, int y, int z) -> const Rgb8* {
      if (x < 0 || y < 0 || z < 0) return nullptr;
      return map.find(tile, std::size_t(x) + r[0] * (std::size_t(y) + r[1] * std::size_t(z)));
    };
    Rgb8 before{};
    for (int z = 0; z < int(r[2]); ++z) {
      for (int y = 0; y < int(r[1]); ++y) {
        for (int x = 0; x < int(r[0]); ++x) {
          const Rgb8* const color = at(x, y, z);
          if (!color) continue;
          for (std::size_t c = 0; c < 3; ++c) {
            int sum = 0, count = 0;
            for (const Rgb8* n : {at(x - 1, y, z), at(x, y - 1, z), at(x, y, z - 1)})
              if (n) sum += (*n)[c], ++count;
            bytes.push_back(std::byte(((*color)[c] - (count > 0 ? sum / count : before[c])) & 255));
          }
          before = *color;
        }
      }
    }
  }
  return bytes;
}

}  // namespace

TEST_CASE("format: surface colors are found by tile and voxel, in memory and by the loader") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    CellObject object = random_small_object(seed);
    Rng rng(seed);
    object.surface_colors = random_surface_colors(rng, object.tile.resolution, object.grid.tile_count());
    const SurfaceColors& map = *object.surface_colors;
    const Bytes file = encoded(object);
    REQUIRE(get(file, 10, 2) == 1);
    REQUIRE(*read_cell_object(file) == object);
    for (const int in_place : {0, 1}) {
      const MesocellOptions options = {1u << 30, 1u << 30, 1u << 20, in_place};
      std::size_t need = 0;
      REQUIRE(mesocell_arena_bytes(file.data(), file.size(), 0, &options, &need, nullptr) == kMesocellOk);
      const auto arena = std::make_unique<std::byte[]>(need);
      MesocellObject loaded;
      REQUIRE(mesocell_load(file.data(), file.size(), 0, &options, arena.get(), need, &loaded, nullptr) ==
              kMesocellOk);
      std::size_t wrong = 0, colored = 0;
      const Index3& r = object.tile.resolution;
      for (std::uint64_t tile = 0; tile < object.grid.tile_count(); ++tile) {
        for (std::uint32_t v = 0; v < object.tile.voxel_count(); ++v) {
          const Index3 voxel = {v % r[0], v / r[0] % r[1], v / r[0] / r[1]};
          const Rgb8* const expected = map.find(tile, map.color_voxel(voxel, r));
          const std::uint8_t* const found = mesocell_surface_color(&loaded, tile, voxel.data());
          wrong += (expected == nullptr) != (found == nullptr) ||
                   (found && !std::equal(found, found + 3, expected->begin()));
          colored += found != nullptr;
        }
      }
      CHECK(wrong == 0);
      CHECK(colored > 0);
    }
  }
}

TEST_CASE("format: a tile voxel has the color voxel that its centre is in") {
  SurfaceColors map;
  for (std::uint32_t tile = 4; tile <= 40; ++tile) {
    for (std::uint32_t r = 1; r <= std::min(tile, SurfaceColors::kMaxResolution); ++r) {
      map.resolution = {r, 1, 1};
      std::size_t last = 0;
      for (std::uint32_t v = 0; v < tile; ++v) {
        const std::size_t c = map.color_voxel({v, 0, 0}, {tile, 4, 4});
        // c / r ≤ (v + ½) / tile < (c + 1) / r
        CHECK((2 * tile * c <= (2 * v + 1) * r && (2 * v + 1) * r < 2 * tile * (c + 1)));
        CHECK((c == last || c == last + 1));
        last = c;
      }
      CHECK(last == r - 1);
    }
  }
}

TEST_CASE("format: surface colors of every shape survive the round trip") {
  Rng rng(5);
  const auto random = [&](std::size_t, std::size_t) { return rng.below(3) > 0; };
  const auto all = [](std::size_t, std::size_t) { return true; };
  const auto last = [](std::size_t, std::size_t v) { return v == 63; };
  for (const Index3& r : {Index3{1, 1, 1}, Index3{4, 1, 1}, Index3{1, 4, 1}, Index3{1, 1, 4}, Index3{3, 3, 3},
                          Index3{4, 4, 4}}) {
    for (const std::uint32_t tiles : {1u, 7u, 8u, 9u, 4096u, 4097u, 8200u}) {
      std::vector<std::uint32_t> bricks = {0, 3, 6, 7, 8, 4094, 4095, 4096, 4100, 8191, 8199};
      std::erase_if(bricks, [&](std::uint32_t t) { return t >= tiles; });
      const CellObject object = row_of(tiles, bricks, r, all);
      const Verdicts v = verdicts(encoded(object));
      CAPTURE(v.why, v.loader_text);
      CHECK((v.agree && v.reader));
      CHECK(*read_cell_object(encoded(object)) == object);
    }
  }
  for (const CellObject& object : {row_of(5000, {4999}, {4, 4, 4}, last), row_of(9, {0, 1}, {4, 4, 4}, last)})
    CHECK(*read_cell_object(encoded(object)) == object);
  // As large as a brick can be, and a resolution that the tile's is no multiple of.
  RandomObjectOptions options;
  options.resolution = {32, 33, 40};
  options.tiles = {3, 1, 1};
  CellObject object = random_object(1, options);
  object.surface_colors = row_of(3, {0, 2}, {32, 32, 32}, random).surface_colors;
  CHECK(*read_cell_object(encoded(object)) == object);
  CHECK(verdicts(encoded(object)).agree);
  object.surface_colors = row_of(3, {1}, {32, 7, 31}, random).surface_colors;
  CHECK(*read_cell_object(encoded(object)) == object);
  CHECK(verdicts(encoded(object)).agree);
}

TEST_CASE("format: surface colors are stored as differences from those before them") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Rng rng(seed);
    const SurfaceColors map = random_surface_colors(rng, {4 + rng.below(30), 4 + rng.below(5), 5}, 20);
    const Bytes expected = differences_by_the_text(map), bytes = encode_surface_colors(map);
    REQUIRE(bytes.size() > expected.size());
    CHECK(std::equal(expected.begin(), expected.end(), bytes.end() - std::ptrdiff_t(expected.size())));
  }
}

TEST_CASE("format: surface colors make a file one of 1.1, and are left out of one of 1.0") {
  CellObject object = small_object();
  const Bytes file = encoded(object);
  CHECK(get(file, 10, 2) == 1);
  // Changes of this hash are changes of the format. Nothing is compressed, so it does not hang on zstd.
  WriteOptions options;
  options.compress = false;
  CHECK(hash64(*encode_cell_object(object, options)) == 0x9b1247f28ef61bc9);
  options = {};
  options.version.minor = 0;
  const auto older = encode_cell_object(object, options);
  REQUIRE(older.ok());
  object.surface_colors.reset();
  CHECK(*older == encoded(object));
}

TEST_CASE("format: a sole fault of SCOL is found") {
  const CellObject object = small_object();
  TestFile parts = TestFile::of(object);
  REQUIRE(parts.payload(kSurfaceColorChunk).size() == kBytes);
  CHECK(verdicts(parts.build()).reader);
  for (std::size_t a = 0; a < 3; ++a) {
    check_sole_fault(with(4 * a, 0), "scol-resolution");
    check_sole_fault(with(4 * a, 5), "scol-resolution");  // the tile has 4
  }
  for (const std::uint32_t bits : {0x7f800000u, 0x80000000u, 0xffffffffu})
    check_sole_fault(with(12, bits), "map-error");
  check_sole_fault(with(24, 1, 1), "payload-reserved");
  check_sole_fault(with(63, 128, 1), "payload-reserved");
  check_sole_fault(with(kBricksAt, 0b111, 1), "scol-brick-count");
  check_sole_fault(with(kBricksAt, 0b100, 1), "scol-brick-count");
  check_sole_fault(with(kBricksAt, 0b1101, 1), "scol-unused-bits");
  check_sole_fault(with(kBricksAt, 0b10000101, 1), "scol-unused-bits");
  for (const std::size_t at :
       {kBricksAt + 1, kRanksAt - 1, kRanksAt + 8, kMasksAt - 1, kMasksAt + 4, kColorsAt - 1})
    check_sole_fault(with(at, 1, 1), "payload-padding");
  for (const std::size_t at : {kRanksAt, kRanksAt + 4}) check_sole_fault(with(at, 1), "scol-rank");
  check_sole_fault(with(20, 12 + 1), "payload-truncated");
  check_sole_fault(edited(object,
                           [](Bytes& scol) {
                             put(scol, 20, 13);
                             scol.resize(scol.size() + 3);
                           }),
                    "scol-color-count");
  check_sole_fault(edited(object, [](Bytes& scol) { scol.push_back({}); }), "payload-trailing");
  check_sole_fault(edited(object, [](Bytes& scol) { scol.pop_back(); }), "payload-truncated");
  check_sole_fault(edited(object, [](Bytes& scol) { scol.resize(63); }), "payload-truncated");
  // Bits after the twelve color voxels of each brick.
  check_sole_fault(with(kMasksAt + 1, get(parts.payload(kSurfaceColorChunk), kMasksAt + 1, 1) | 0x10, 1),
                    "scol-unused-bits");
  check_sole_fault(with(kMasksAt + 3, get(parts.payload(kSurfaceColorChunk), kMasksAt + 3, 1) | 0x80, 1),
                    "scol-unused-bits");
  // All colors in one of the two bricks.
  for (const std::size_t full : {0u, 2u}) {
    check_sole_fault(edited(object,
                             [&](Bytes& scol) {
                               put(scol, kMasksAt, 0, 4);
                               put(scol, kMasksAt + full, 0xfff, 2);
                             }),
                      "scol-empty-brick");
  }
  // Without any brick.
  check_sole_fault(edited(object,
                           [](Bytes& scol) {
                             put(scol, 16, 0, 8);
                             put(scol, kBricksAt, 0, 1);
                             scol.resize(kMasksAt);
                           }),
                    "scol-brick-count");
  // Ranks of the second page: bricks, and colors.
  const CellObject paged = row_of(4097, {1, 4095}, {2, 1, 1}, [](std::size_t, std::size_t) { return true; });
  const std::size_t ranks = 64 + 576;
  REQUIRE(get(TestFile::of(paged).payload(kSurfaceColorChunk), ranks + 8, 8) == (2 | std::uint64_t{4} << 32));
  for (const std::uint32_t wrong : {0u, 1u, 3u, 0x80000002u})
    check_sole_fault(edited(paged, [&](Bytes& scol) { put(scol, ranks + 8, wrong); }), "scol-rank");
  for (const std::uint32_t wrong : {0u, 2u, 5u, 0x80000004u})
    check_sole_fault(edited(paged, [&](Bytes& scol) { put(scol, ranks + 12, wrong); }), "scol-rank");
}

TEST_CASE("format: SCOL in a file of 1.0 is unknown, and critical it is a fault") {
  TestFile parts = TestFile::of(small_object());
  parts.chunk(kSurfaceColorChunk).flags = 1;
  check_sole_fault(parts.build(), "chunk-criticality");
  parts.chunk(kSurfaceColorChunk).flags = 0;
  parts.set_payload(kSurfaceColorChunk, Bytes(3));
  check_sole_fault(parts.build(), "payload-truncated");
  parts.minor = 0;
  const Verdicts v = verdicts(parts.build());
  CHECK((v.agree && v.reader));
  CHECK(v.issues == std::vector<std::string>{"chunk-unknown-skippable"});
  CHECK_FALSE(read_cell_object(parts.build())->surface_colors.has_value());
}

TEST_CASE("format: huge counts in a small SCOL are refused before memory is taken") {
  for (const std::size_t at : {std::size_t{16}, std::size_t{20}}) {
    const Verdicts v = verdicts(with(at, 0xffffffff));
    CHECK(v.agree);
    CHECK_FALSE(v.limit);
    CHECK(v.reader_id == "payload-truncated");
  }
}
