#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "format/cell_object_chunks.h"
#include "tests/format/sole_fault.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

/// Files that break one rule and keep all others, where one fault usually brings more. If a reader forgot
/// that rule, nothing else would stop the file.
namespace {

/// The walk-through's object with a tile of this resolution and the grid of these tiles, all INSIDE.
CellObject resized(const Index3& resolution, const Index3& tiles) {
  CellObject object = walkthrough_object();
  object.tile.resolution = resolution;
  object.tile.cell_count = 1;
  object.tile.pieces = {{1, {0, 0, 0}}};
  object.tile.voxel_ids.assign(std::size_t(object.tile.voxel_count()), 1);
  object.grid.tiles = object.membership.tiles = tiles;
  object.membership.cell_count = 1;
  object.membership.blocks.clear();
  object.membership.entries.assign(std::size_t(object.grid.tile_count()), 1);
  return object;
}

/// The walk-through with one chunk's payload changed.
Bytes edited(std::uint32_t type, const std::function<void(Bytes&)>& edit) {
  TestFile parts = TestFile::of(walkthrough_object());
  Bytes payload = parts.payload(type);
  edit(payload);
  parts.set_payload(type, payload);
  return parts.build();
}

/// The walk-through with its TILE in this frame, which zstd itself decodes.
Bytes framed(const std::function<Bytes(const Bytes&)>& frame) {
  TestFile parts = TestFile::of(walkthrough_object());
  TestChunk& tile = parts.chunk(kTileChunk);
  tile.codec = 1;
  tile.stored = frame(tile.stored);
  return parts.build();
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

TEST_CASE("format: a sole fault of the container is found") {
  TestFile many = TestFile::of(walkthrough_object());
  for (std::uint32_t i = 0; i < 4092; ++i) many.chunks.push_back({0x80000000 + i, 0, 0, 0, {}});
  CHECK(verdicts(many.build()).reader);
  many.chunks.push_back({0x70000000, 0, 0, 0, {}});
  check_sole_fault(many.build(), "chunk-count");

  // Entries that change places still cover the file, but not in order.
  Bytes swapped = TestFile::of(walkthrough_object()).build();
  std::swap_ranges(swapped.begin() + entry_at(0), swapped.begin() + entry_at(1),
                   swapped.begin() + entry_at(1));
  reseal_directory(swapped);
  const Verdicts v = verdicts(swapped);
  CHECK(v.agree);
  CHECK(v.reader_id == "chunk-offset");
  for (const std::string& id : v.issues) CHECK(id == "chunk-offset");
}

TEST_CASE("format: a frame that zstd decodes and the format does not allow is found") {
  // Content size in one byte, dictionary id in one: 0, that is none.
  const auto with_dictionary_id = [](const Bytes& content) {
    return zstd_frame_with_header(content, {0x21, 0, std::uint8_t(content.size())});
  };
  check_sole_fault(framed(with_dictionary_id), "zstd-frame");
  Bytes skippable(8);
  put(skippable, 0, 0x184D2A50, 4);
  check_sole_fault(framed([&](const Bytes& b) { return zstd_frame(b) + skippable; }), "zstd-frame");
  check_sole_fault(framed([&](const Bytes& b) { return skippable + zstd_frame(b); }), "zstd-frame");
  check_sole_fault(framed([](const Bytes& b) { return zstd_frame(b) + zstd_frame({}); }), "zstd-frame");
}

TEST_CASE("format: a sole fault of GRID or TILE is found") {
  CHECK(verdicts(TestFile::of(resized({4, 1024, 5}, {7, 5, 3})).build()).reader);
  for (std::size_t a = 0; a < 3; ++a) {
    for (const std::uint32_t r : {3u, 1025u}) {
      Index3 resolution = {4, 4, 4};
      resolution[a] = r;
      check_sole_fault(resized(resolution, {1, 1, 1}), "tile-resolution");
    }
    Index3 resolution = {4, 4, 4}, tiles = {1, 1, 1};
    resolution[a] = 1024;
    tiles[a] = 1u << 20;
    CHECK(verdicts(TestFile::of(resized(resolution, tiles)).build()).reader);
    tiles[a] += 1;
    check_sole_fault(resized(resolution, tiles), "grid-extent");
  }

  CellObject no_cells = resized({4, 4, 4}, {2, 1, 1});
  no_cells.tile.cell_count = no_cells.membership.cell_count = 0;
  no_cells.tile.pieces.clear();
  no_cells.tile.voxel_ids.assign(64, 0);
  const Verdicts v = verdicts(TestFile::of(no_cells).build());
  CHECK(v.agree);
  CHECK(v.reader_id == "tile-cell-count");

  CellObject cell_left_out = walkthrough_object();
  cell_left_out.tile.cell_count = cell_left_out.membership.cell_count = 3;
  check_sole_fault(cell_left_out, "cell-without-piece");

  CellObject twice = walkthrough_object();
  twice.tile.pieces = {{1, {0, 0, 0}}, {2, {0, 0, 0}}, {1, {0, 0, 0}}, {2, {0, 0, 0}}};
  twice.tile.voxel_ids[63] = 4;
  check_sole_fault(twice, "piece-order");

  for (const unsigned id_bytes : {2u, 4u}) {
    check_sole_fault(edited(kTileChunk,
                            [&](Bytes& tile) {
                              Bytes wide(tile.begin(), tile.begin() + 128);
                              for (std::size_t i = 128; i < tile.size(); ++i) {
                                wide.push_back(tile[i]);
                                wide.resize(wide.size() + id_bytes - 1);
                              }
                              put(wide, 20, id_bytes);
                              tile = wide;
                            }),
                     "tile-id-bytes");
  }
}

TEST_CASE("format: a sole fault of MEMB is found") {
  // States are INSIDE and mixed; one rank, one byte of tags.
  for (std::size_t at = 2 * 2; at < 8; at += 2) {
    check_sole_fault(edited(kMembershipChunk, [&](Bytes& m) { put(m, 64, 0b1101u | 1u << at, 1); }),
                     "memb-unused-bits");
  }
  for (const std::size_t at : {std::size_t{65}, std::size_t{127}, std::size_t{132}, std::size_t{191}})
    check_sole_fault(edited(kMembershipChunk, [&](Bytes& m) { put(m, at, 1, 1); }), "payload-padding");
  check_sole_fault(edited(kMembershipChunk, [](Bytes& m) { put(m, 128, 1, 4); }), "memb-rank");
  check_sole_fault(edited(kMembershipChunk, [](Bytes& m) { put(m, 63, 1, 1); }), "payload-reserved");
  // Pages of 4096 tiles: a mixed tile in the first is counted in the rank of the second.
  CellObject paged = walkthrough_object();
  paged.grid.tiles = paged.membership.tiles = {4097, 1, 1};
  paged.membership.entries.assign(4097, 1);
  paged.membership.entries[4095] = MembershipMap::kFirstBlock;
  TestFile pages = TestFile::of(paged);
  CHECK(verdicts(pages.build()).reader);
  Bytes memb = pages.payload(kMembershipChunk);
  const std::size_t ranks = 64 + 1088;
  REQUIRE(get(memb, ranks + 4) == 1);
  for (const std::uint32_t rank : {0u, 2u, 0x80000001u}) {
    put(memb, ranks + 4, rank);
    pages.set_payload(kMembershipChunk, memb);
    check_sole_fault(pages.build(), "memb-rank");
  }

  for (const unsigned uniform : {0b0000u, 0b0101u, 0b1010u}) {
    CellObject all_same = walkthrough_object();
    all_same.membership.blocks = {std::uint8_t(uniform)};
    check_sole_fault(all_same, "memb-uniform");
  }
  // A tag of 3 that the counts leave out.
  check_sole_fault(edited(kMembershipChunk,
                          [](Bytes& m) {
                            put(m, m.size() - 1, 0b1101, 1);
                            put(m, 24, 0, 8);
                          }),
                   "memb-tag");
  // Unused bits are after the second cell.
  for (unsigned bit = 4; bit < 8; ++bit) {
    check_sole_fault(
        edited(kMembershipChunk, [&](Bytes& m) { put(m, m.size() - 1, 0b1001u | 1u << bit, 1); }),
        "memb-unused-bits");
  }
}

TEST_CASE("format: a sole fault of a color chunk is found") {
  for (std::size_t a = 0; a < 3; ++a) {
    CellObject object = walkthrough_object();
    ColorMap& color = object.color.emplace();
    color.resolution = {1, 1, 1};
    color.resolution[a] = 1024;
    color.voxels.assign(1024, {1, 2, 3});
    CHECK(verdicts(TestFile::of(object).build()).reader);
    color.resolution[a] = 1025;
    color.voxels.push_back({});
    check_sole_fault(object, "color-resolution");
    color.resolution[a] = 0;
    color.voxels.clear();
    check_sole_fault(object, "color-resolution");
  }
  CellObject object = walkthrough_object();
  object.cell_colors.emplace().colors.assign(2, {255, 255, 255});
  object.instance_colors.emplace().colors.assign(3, {0, 0, 0});
  CHECK(verdicts(TestFile::of(object).build()).reader);
  for (const std::size_t count : {1, 3, 64}) {
    object.cell_colors->colors.resize(count);
    check_sole_fault(object, count < 2 ? "payload-truncated" : "payload-trailing");
  }
  object.cell_colors.reset();
  for (const std::size_t count : {2, 4}) {
    object.instance_colors->colors.resize(count);
    check_sole_fault(object, count < 3 ? "payload-truncated" : "payload-trailing");
  }
}

TEST_CASE("format: instance colors of an object without INSIDE instances are none") {
  CellObject object = walkthrough_object();
  object.membership.entries = {0, 0};
  object.membership.blocks.clear();
  TestFile parts = TestFile::of(object);
  parts.chunks.push_back({kInstanceColorChunk, 0, 0, 64, Bytes(64)});
  const Verdicts none = verdicts(parts.build());
  CHECK(none.agree);
  CHECK(none.reader);
  parts.set_payload(kInstanceColorChunk, Bytes(67));
  const Verdicts more = verdicts(parts.build());
  CHECK(more.agree);
  CHECK(more.reader_id == "payload-trailing");
}

TEST_CASE("format: a sole fault of MESH is found") {
  CellObject object = walkthrough_object();
  object.basic_mesh = BasicMesh{Bytes(100, std::byte{5}), 8, 12, 0.5f};
  CHECK(verdicts(TestFile::of(object).build()).reader);
  object.basic_mesh->vertices = 2;
  check_sole_fault(object, "mesh-counts");
  object.basic_mesh->vertices = 3;
  object.basic_mesh->triangles = 0;
  check_sole_fault(object, "mesh-counts");
  object.basic_mesh->triangles = 1;
  TestFile parts = TestFile::of(object);
  Bytes payload = parts.payload(kBasicMeshChunk);
  payload.pop_back();
  parts.set_payload(kBasicMeshChunk, payload);
  check_sole_fault(parts.build(), "mesh-bytes");
  payload.push_back({});
  payload[0] = std::byte{1};
  parts.set_payload(kBasicMeshChunk, payload);
  check_sole_fault(parts.build(), "mesh-encoding");
}

TEST_CASE("format: a sole fault of NORM is found") {
  // Both cells lie at the border with empty space everywhere: all voxels of the lower half but none above.
  CellObject object = walkthrough_object();
  NormalMap& map = object.normals.emplace();
  map.normals.assign(24, {0, 252});
  CHECK(verdicts(TestFile::of(object).build()).reader);
  map.normals[23][1] = 253;
  check_sole_fault(object, "normal-code");
  map.normals.pop_back();
  check_sole_fault(object, "payload-truncated");
  map.normals.resize(25);
  check_sole_fault(object, "payload-trailing");
  TestFile odd = TestFile::of(object);
  odd.set_payload(kNormalChunk, Bytes(64 + 49));
  check_sole_fault(odd.build(), "payload-trailing");
}
