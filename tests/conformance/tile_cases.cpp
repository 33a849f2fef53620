#include <algorithm>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::size_t kCellCountAt = 12, kPieceCountAt = 16, kIdBytesAt = 20, kTileFieldBytes = 24;

Bytes with_tile(std::size_t at, std::uint64_t value, unsigned bytes = 4) {
  return with(tiny(), kTileChunk, at, value, bytes);
}

Bytes packed(const CellObject& object) {
  TestFile parts = TestFile::of(object);
  if (object.metadata.empty()) parts.chunks.pop_back();
  for (TestChunk& c : parts.chunks) pack(c);
  return parts.build();
}

/// The ids of a TILE with more or fewer bytes each.
Bytes with_id_bytes(const CellObject& object, unsigned id_bytes) {
  TestFile parts = TestFile::of(object);
  parts.chunks.pop_back();
  const TileMap& tile = object.tile;
  return edited(parts, kTileChunk, [&](Bytes& bytes) {
    bytes.resize(bytes.size() - tile.voxel_ids.size());
    for (std::size_t i = 0; i < tile.voxel_count(); ++i) {
      bytes.push_back(std::byte(tile.id(i) & 0xff));
      if (id_bytes > 1) bytes.push_back(std::byte(tile.id(i) >> 8));
      for (unsigned b = 2; b < id_bytes; ++b) bytes.push_back(std::byte{0});
    }
    put(bytes, kIdBytesAt, id_bytes);
  });
}

void add_resolution_cases(CaseList& cases) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = kAxes[a];
    for (const std::uint32_t r :
         {0u, 1u, 2u, 1026u, 1028u, 2048u, 65540u, 0x04000000u, 0x80000004u, 0xffffffffu})
      cases.fault("tile-resolution/" + axis + "-" + to_string(r), with_tile(4 * a, r));
    // With as many ids as that would need.
    for (const std::uint32_t r : {3u, 1025u}) {
      Index3 resolution = {4, 4, 4};
      resolution[a] = r;
      cases.fault("tile-resolution/" + axis + "-really-" + to_string(r),
                  packed(solid_object(resolution, {1, 1, 1})));
    }
    Index3 resolution = {5, 6, 7};
    resolution[a] = 1024;
    cases.valid("tile/1024-along-" + axis, "4.2", packed(solid_object(resolution, {2, 1, 1})));
    resolution = {9, 10, 11};
    resolution[a] = 4;
    cases.valid("tile/4-along-" + axis, "4.2", packed(solid_object(resolution, {1, 2, 1})));
  }
  cases.fault("tile-resolution/all-zero",
              edited(tiny(), kTileChunk, [](Bytes& tile) { std::fill_n(tile.begin(), 12, std::byte{0}); }));
}

void add_tile_count_cases(CaseList& cases) {
  for (const std::uint32_t count : {0u, 65536u, 65537u, 65538u, 0x02000000u, 0x80000002u, 0xffffffffu})
    cases.fault("tile-cell-count/" + to_string(count), with_tile(kCellCountAt, count));
  // No cell, no piece, no voxel, and a membership of none.
  cases.faults("tile-cell-count/really-0", [] {
    CellObject object = solid_object({4, 4, 4}, {2, 1, 1});
    object.tile.cell_count = object.membership.cell_count = 0;
    object.tile.pieces.clear();
    object.tile.voxel_ids.assign(64, 0);
    return packed(object);
  }());
  for (const std::uint32_t count : {0u, 1u, 65u, 259u, 65539u, 0x03000000u, 0x80000003u, 0xffffffffu})
    cases.fault("tile-piece-count/" + to_string(count), with_tile(kPieceCountAt, count));
  cases.fault("tile-piece-count/fewer-than-cells", with_tile(kCellCountAt, 4));
  cases.fault("tile-piece-count/fewer-than-65535-cells", with_tile(kCellCountAt, 65535));
  for (const std::uint32_t bytes : {0u, 2u, 3u, 4u, 8u, 257u, 0x01000000u, 0xffffffffu})
    cases.fault("tile-id-bytes/" + to_string(bytes), with_tile(kIdBytesAt, bytes));
  for (const unsigned bytes : {2u, 3u, 4u})
    cases.fault("tile-id-bytes/really-" + to_string(bytes) + "-for-3", with_id_bytes(tiny_object(), bytes));
  cases.fault("tile-id-bytes/really-2-for-255", with_id_bytes(many_cells_object(255), 2));
  cases.fault("tile-id-bytes/really-4-for-255", with_id_bytes(many_cells_object(255), 4));
  cases.fault("tile-id-bytes/really-1-for-256", with_id_bytes(many_cells_object(256), 1));
  cases.fault("tile-id-bytes/really-4-for-256", with_id_bytes(many_cells_object(256), 4));
  for (const std::uint32_t cells : {2u, 3u, 4u, 5u, 7u, 8u, 9u, 63u, 64u, 254u, 255u, 256u}) {
    TestFile parts = TestFile::of(many_cells_object(cells));
    parts.chunks.pop_back();
    cases.valid("tile/" + to_string(cells) + "-cells", "4.2", parts.build());
  }
  cases.valid("tile/a-piece-for-every-voxel", "4.2", packed(many_cells_object(256)));
  // Sizes that follow from other numbers of pieces or bytes an id, with the same bytes.
  for (const std::size_t bytes : {64u, 65u, 72u, 80u, 87u, 88u, 89u, 96u, 127u, 128u, 129u, 160u, 190u, 191u})
    cases.fault("payload-truncated/tile-" + to_string(bytes), with_size(tiny(), kTileChunk, bytes));
  for (const std::size_t bytes : {193u, 194u, 196u, 200u, 255u, 256u, 320u})
    cases.fault("payload-trailing/tile-" + to_string(bytes), with_size(tiny(), kTileChunk, bytes));
  cases.fault("payload-truncated/tile-resolution-x-one-more", with_tile(0, 5));
  cases.fault("payload-truncated/tile-resolution-y-one-more", with_tile(4, 5));
  cases.fault("payload-truncated/tile-resolution-z-one-more", with_tile(8, 5));
  cases.fault("payload-truncated/tile-greatest", edited(tiny(), kTileChunk, [](Bytes& tile) {
                for (std::size_t a = 0; a < 3; ++a) put(tile, 4 * a, 1024);
              }));
  cases.fault("payload-truncated/tile-pieces-without-padding", edited(tiny(), kTileChunk, [](Bytes& tile) {
                tile.erase(tile.begin() + 88, tile.begin() + 128);
              }));
  for (std::size_t at = 88; at < 128; at += at < 92 || at > 122 ? 1 : 4)
    cases.fault("payload-padding/tile-" + to_string(at), with_bit(tiny(), kTileChunk, at, at % 8));
  // 8 pieces end at a multiple of 64, and 9 do not.
  for (const std::uint32_t cells : {8u, 9u}) {
    TestFile parts = TestFile::of(many_cells_object(cells));
    parts.chunks.pop_back();
    const std::size_t end = 64 + 8 * cells;
    cases.fault("payload-truncated/tile-of-" + to_string(cells) + "-pieces",
                with_size(parts, kTileChunk, (end + 63) / 64 * 64 + 255));
    if (end % 64 != 0) cases.fault("payload-padding/tile-of-9-pieces", with_bit(parts, kTileChunk, end, 0));
  }
}

void add_big_cases(CaseList& cases) {
  // 65536 voxels of as many pieces: ids of 2 bytes and of 4. Too large for a file of the suite.
  CellObject object = tiny_object();
  TileMap& tile = object.tile;
  tile.resolution = {64, 64, 16};
  const auto fill = [&](std::uint32_t pieces, std::uint32_t cells) {
    tile.cell_count = object.membership.cell_count = cells;
    tile.id_bytes = TileMap::id_bytes_for(pieces);
    tile.pieces.clear();
    tile.voxel_ids.clear();
    // A second piece of the last cell, in the tile before.
    for (std::uint32_t c = 1; c <= cells; ++c) tile.pieces.push_back({std::uint16_t(c), {0, 0, 0}});
    for (std::uint32_t p = cells; p < pieces; ++p) {
      tile.pieces.back().home = {-1, 0, 0};
      tile.pieces.push_back({std::uint16_t(cells), {0, 0, 0}});
    }
    for (std::uint32_t v = 0; v < 65536; ++v) {
      const std::uint32_t id = v < pieces ? v + 1 : 0;
      for (std::uint32_t b = 0; b < tile.id_bytes; ++b) tile.voxel_ids.push_back(std::uint8_t(id >> (8 * b)));
    }
    object.membership.blocks.assign(object.membership.block_bytes(), 0);
    object.membership.blocks[0] = 1;
    TestFile parts = TestFile::of(object);
    parts.chunks.pop_back();
    return parts;
  };
  cases.valid("tile/65535-cells", "4.2", fill(65535, 65535).build());
  TestFile wide = fill(65536, 65535);
  cases.valid("tile/65536-pieces", "4.2", wide.build());
  const std::size_t ids = 64 + 65536 * 8;
  cases.fault("voxel-id/65537-of-65536", with(wide, kTileChunk, ids, 65537));
  cases.fault("voxel-id/sign-bit", with(wide, kTileChunk, ids + 4 * 65535, 0x80010000));
  cases.fault("tile-id-bytes/really-2-for-65536", with_id_bytes(object, 2));
  (void)fill(65535, 65535);
  cases.fault("tile-id-bytes/really-4-for-65535", with_id_bytes(object, 4));
}

}  // namespace

void add_tile_cases(CaseList& cases) {
  add_chunk_header_cases(cases, tiny(), kTileChunk, kTileFieldBytes);
  add_resolution_cases(cases);
  add_tile_count_cases(cases);
  add_big_cases(cases);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CellObject object = random_small_object(seed);
    object.surface_colors.reset();
    TestFile parts = TestFile::of(object);
    if (seed % 2 == 0)
      for (TestChunk& c : parts.chunks) pack(c);
    cases.valid("object/random-" + to_string(seed), "4", parts.build());
  }
}

}  // namespace mesocell::test
