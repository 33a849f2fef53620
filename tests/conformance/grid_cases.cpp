#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::size_t kEdgeAt = 24, kTilesAt = 32, kGridFieldBytes = 44;

constexpr std::array<std::pair<const char*, std::uint64_t>, 6> kNotFinite = {
    {{"infinity", 0x7ff0000000000000},
     {"minus-infinity", 0xfff0000000000000},
     {"signalling-nan", 0x7ff0000000000001},
     {"quiet-nan", 0x7ff8000000000000},
     {"minus-nan", 0xfff8000000000000},
     {"all-ones", 0xffffffffffffffff}}};

Bytes with_grid(std::size_t at, std::uint64_t value, unsigned bytes) {
  return with(tiny(), kGridChunk, at, value, bytes);
}

Bytes with_box(double x, double y, double z, double edge) {
  return edited(tiny(), kGridChunk, [&](Bytes& grid) {
    const std::array<double, 4> values = {x, y, z, edge};
    for (std::size_t i = 0; i < 4; ++i) put(grid, 8 * i, bits(values[i]), 8);
  });
}

Bytes with_tiles(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return edited(tiny(), kGridChunk, [&](Bytes& grid) {
    const std::array<std::uint32_t, 3> tiles = {x, y, z};
    for (std::size_t i = 0; i < 3; ++i) put(grid, kTilesAt + 4 * i, tiles[i]);
  });
}

/// One cell in a grid of many tiles, all INSIDE, as small as frames by hand make it. MEMB is made without the
/// tiles in memory.
Bytes solid(const Index3& resolution, const Index3& tiles) {
  CellObject object = solid_object(resolution, {1, 1, 1});
  object.grid.tiles = tiles;
  TestFile parts = TestFile::of(object);
  parts.chunks.pop_back();
  const std::uint64_t count = object.grid.tile_count();
  const MembershipLayout layout = MembershipLayout::of(count, 1, 0);
  Bytes memb(layout.bytes);
  put(memb, 4, 1);
  put(memb, 8, count, 8);
  std::fill_n(memb.begin() + std::ptrdiff_t(layout.states_at), count / 4, std::byte{0x55});
  if (count % 4 != 0) put(memb, layout.states_at + count / 4, 0x55u & ((1u << 2 * (count % 4)) - 1), 1);
  parts.set_payload(kMembershipChunk, memb);
  for (TestChunk& c : parts.chunks) {
    if (c.type == kGridChunk || c.stored.size() < 1024) continue;
    if (c.stored.size() <= 8388608) {
      pack(c);
    } else {
      split_by_hand(c, 8388608, true);
    }
  }
  return parts.build();
}

void add_box_cases(CaseList& cases) {
  constexpr double kGreatest = std::numeric_limits<double>::max();
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  cases.valid("grid/at-the-origin-below", "4.1", with_box(-2, -1, -1, 0.25));
  cases.valid("grid/minus-zero", "4.1", with_box(-0.0, -0.0, -0.0, 0.25));
  cases.valid("grid/least-edge", "4.1", with_box(0, 0, 0, kLeast));
  cases.valid("grid/greatest-edge", "4.1", with_box(0, 0, 0, kGreatest / 8));
  cases.valid("grid/greatest-edge-from-below", "4.1",
              with_box(-kGreatest, -kGreatest, -kGreatest, kGreatest / 8));
  cases.valid("grid/box-min-is-the-least", "4.1", with_box(kLeast, -kLeast, kLeast, 1));
  cases.valid("grid/greatest-box-max", "4.1", with_box(kGreatest / 2, 0, 0, kGreatest / 16));
  // 4 voxels of 1 are the distance of neighbours here: 2 to the 54.
  const double far = 0x1p54;
  cases.valid("grid/far-away", "4.1", with_box(far, far, far, 1));
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = kAxes[a];
    for (const auto& [name, value] : kNotFinite)
      cases.fault("grid-box/" + axis + "-" + name, with_grid(8 * a, value, 8));
    std::array<double, 3> at = {0, 0, 0};
    at[a] = kGreatest;
    cases.fault("grid-box/" + axis + "-greatest", with_box(at[0], at[1], at[2], 0.25));
    at[a] = -kGreatest;
    cases.fault("grid-box/" + axis + "-least", with_box(at[0], at[1], at[2], 0.25));
    at[a] = 0x1p60;
    cases.fault("grid-box/" + axis + "-too-far-for-the-edge", with_box(at[0], at[1], at[2], 1));
    at[a] = -0x1p60;
    cases.fault("grid-box/" + axis + "-too-far-below-for-the-edge", with_box(at[0], at[1], at[2], 1));
    at[a] = kGreatest / 4 * 3;
    cases.fault("grid-box/" + axis + "-maximum-overflows", with_box(at[0], at[1], at[2], kGreatest / 8));
  }
  cases.fault("grid-box/edge-overflows", with_box(0, 0, 0, kGreatest));
  cases.fault("grid-box/edge-overflows-along-x-alone", with_box(0, 0, 0, kGreatest / 7));
  for (const auto& [name, value] : kNotFinite)
    cases.fault("grid-voxel-edge/" + std::string(name), with_grid(kEdgeAt, value, 8));
  cases.fault("grid-voxel-edge/zero", with_grid(kEdgeAt, 0, 8));
  cases.fault("grid-voxel-edge/minus-zero", with_grid(kEdgeAt, bits(-0.0), 8));
  cases.fault("grid-voxel-edge/minus-least", with_grid(kEdgeAt, bits(-kLeast), 8));
  cases.fault("grid-voxel-edge/minus-quarter", with_grid(kEdgeAt, bits(-0.25), 8));
  cases.fault("grid-voxel-edge/minus-greatest", with_grid(kEdgeAt, bits(-kGreatest), 8));
}

void add_tiles_cases(CaseList& cases) {
  const std::array<std::pair<const char*, Index3>, 16> counts = {{
      {"none-along-x", {0, 1, 1}},
      {"none-along-y", {2, 0, 1}},
      {"none-along-z", {2, 1, 0}},
      {"none", {0, 0, 0}},
      {"none-by-much", {0, 0xffffffff, 0xffffffff}},
      {"2-to-31-along-x", {0x80000000, 1, 1}},
      {"2-to-31-along-y", {1, 0x80000000, 1}},
      {"2-to-31-along-z", {1, 1, 0x80000000}},
      {"2-to-31-in-all", {2048, 1024, 1024}},
      {"2-to-31-in-two", {65536, 32768, 1}},
      {"2-to-32-in-two", {65536, 65536, 1}},
      {"2-to-32-and-two", {2, 0x80000001, 1}},
      {"2-to-64", {1u << 22, 1u << 21, 1u << 21}},
      {"2-to-66", {1u << 22, 1u << 22, 1u << 22}},
      {"all-ones-along-x", {0xffffffff, 1, 1}},
      {"all-ones", {0xffffffff, 0xffffffff, 0xffffffff}},
  }};
  for (const auto& [name, tiles] : counts)
    cases.fault("grid-tiles/" + std::string(name), with_tiles(tiles[0], tiles[1], tiles[2]));
  for (const std::size_t bytes : {65u, 68u, 72u, 127u, 128u, 256u})
    cases.fault("payload-trailing/grid-" + to_string(bytes), with_size(tiny(), kGridChunk, bytes));

  // 2 to the 30 voxels along an axis are the most.
  for (std::size_t a = 0; a < 3; ++a) {
    for (const std::uint32_t along : {512u, 1024u}) {
      Index3 resolution = {4, 4, 4}, tiles = {1, 1, 1};
      resolution[a] = along;
      tiles[a] = (1u << 30) / resolution[a];
      const std::string name = std::string(kAxes[a]) + "-at-" + to_string(resolution[a]);
      cases.valid("grid/longest-" + name, "4.1", solid(resolution, tiles));
      ++tiles[a];
      cases.fault("grid-extent/" + name, solid(resolution, tiles));
      tiles[a] *= 2;
      cases.fault("grid-extent/twice-" + name, solid(resolution, tiles));
    }
  }
  // In 32 bits this is no more than 1024.
  cases.fault("grid-extent/wraps", solid({1024, 4, 4}, {(1u << 22) + 1, 1, 1}));

  // The default limit is 2 to the 28 tiles.
  cases.limit("one-tile-more", solid({4, 4, 4}, {16384, 16385, 1}));
  cases.valid("grid/a-million-tiles", "4.1", solid({4, 4, 4}, {128, 64, 128}));
  const ReadLimits few = {.max_tiles = 23};
  const Bytes tiles24 = solid({4, 4, 4}, {2, 3, 4});
  cases.limit("24-tiles-of-23", tiles24, few);
  cases.valid("limits/24-tiles-of-24", "6", tiles24, {}, {.max_tiles = 24});
  const Bytes file = small().build();
  cases.limit("file-bytes", file, {.max_file_bytes = file.size() - 1});
  cases.valid("limits/file-bytes", "6", file, {}, {.max_file_bytes = file.size()});
  cases.limit("decoded-bytes", with_grid(0, bits(1.0), 8), {.max_decoded_bytes = 448});
}

}  // namespace

void add_grid_cases(CaseList& cases) {
  add_chunk_header_cases(cases, tiny(), kGridChunk, kGridFieldBytes);
  add_box_cases(cases);
  add_tiles_cases(cases);
}

}  // namespace mesocell::test
