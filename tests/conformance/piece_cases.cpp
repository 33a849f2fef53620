#include <algorithm>
#include <array>
#include <utility>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// Pieces and ids of TILE. [spec 4.2]
namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::size_t kPieceBytes = 8;

/// Three cells; voxels 0, 1, 2 … have ids 1, 2, 3 …, the others the last one. Whether homes are right, pieces
/// say.
CellObject with_pieces(std::vector<Piece> pieces, std::uint32_t cells = 3) {
  CellObject object = tiny_object();
  object.tile.cell_count = object.membership.cell_count = cells;
  if (cells > 1) {
    object.membership.blocks = {0b01};
  } else {
    object.membership.entries = {1, 1};
    object.membership.blocks.clear();
  }
  object.tile.pieces = std::move(pieces);
  for (std::size_t v = 0; v < 64; ++v)
    object.tile.voxel_ids[v] = std::uint8_t(std::min(v + 1, object.tile.pieces.size()));
  return object;
}

Bytes built(const CellObject& object) {
  TestFile parts = TestFile::of(object);
  parts.chunks.pop_back();
  return parts.build();
}

Bytes with_homes(std::array<std::int8_t, 3> first, std::array<std::int8_t, 3> second) {
  return built(with_pieces({{1, {0, 0, 0}}, {2, first}, {2, second}, {3, {0, 0, 0}}}));
}

void add_piece_cases_of_rows(CaseList& cases) {
  const CellObject base =
      with_pieces({{1, {-1, 0, 0}}, {1, {0, 0, 0}}, {2, {0, 0, 0}}, {3, {0, 0, 0}}, {3, {1, 0, 0}}});
  TestFile parts = TestFile::of(base);
  parts.chunks.pop_back();
  const auto cell = [&](std::size_t piece, std::uint32_t value) {
    return with(parts, kTileChunk, kPiecesAt + kPieceBytes * piece, value, 2);
  };
  cases.fault("piece-cell/zero", cell(0, 0));
  cases.fault("piece-cell/4-of-3", cell(4, 4));
  cases.fault("piece-cell/5-of-3", cell(4, 5));
  cases.fault("piece-cell/256-more", cell(4, 259));
  cases.fault("piece-cell/big-endian", cell(4, 0x0300));
  cases.fault("piece-cell/sign-bit", cell(4, 0x8003));
  cases.fault("piece-cell/all-ones", cell(4, 0xffff));
  cases.faults("piece-cell/zero-in-the-middle", cell(2, 0));
  cases.faults("piece-cell/4-in-the-middle", cell(2, 4));
  cases.faults("piece-cell/all-zero", edited(parts, kTileChunk, [](Bytes& tile) {
                 for (std::size_t i = 0; i < 5; ++i) put(tile, kPiecesAt + kPieceBytes * i, 0, 2);
               }));
  for (std::size_t piece = 0; piece < 5; ++piece) {
    for (std::size_t byte = 5; byte < 8; ++byte) {
      for (const unsigned bit : {0u, 7u})
        cases.fault("piece-reserved/" + to_string(piece) + "-" + to_string(byte) + "-" + to_string(bit),
                    with_bit(parts, kTileChunk, kPiecesAt + kPieceBytes * piece + byte, bit));
    }
  }
  // Order: by cell, then home z, y, x; homes have signs.
  using Home = std::array<std::int8_t, 3>;
  constexpr Home o = {0, 0, 0};
  cases.fault("piece-cell/zero-at-home", built(with_pieces({{0, o}, {1, o}, {2, o}, {3, o}})));
  // Of cell 2, and none of them before the piece at home: the home rule is kept.
  const std::array<std::pair<const char*, std::array<Home, 3>>, 11> orders = {{
      {"same", {{{-1, 0, 0}, {-1, 0, 0}, o}}},
      {"x-descending", {{{-1, 0, 0}, {-2, 0, 0}, o}}},
      {"y-descending", {{{0, -1, 0}, {0, -2, 0}, o}}},
      {"z-descending", {{{0, 0, -1}, {0, 0, -2}, o}}},
      {"x-as-unsigned", {{{-2, 0, 0}, o, {-1, 0, 0}}}},
      {"y-as-unsigned", {{{0, -2, 0}, o, {0, -1, 0}}}},
      {"z-as-unsigned", {{{0, 0, -2}, o, {0, 0, -1}}}},
      {"x-before-y", {{{-3, -1, 0}, {-2, -2, 0}, o}}},
      {"x-before-z", {{{-3, 0, -1}, {-2, 0, -2}, o}}},
      {"y-before-z", {{{0, -3, -1}, {0, -2, -2}, o}}},
      {"greatest-before-least", {{{127, -1, 0}, {-128, -1, 0}, o}}},
  }};
  for (const auto& [name, homes] : orders)
    cases.fault("piece-order/" + std::string(name),
                built(with_pieces({{1, o}, {2, homes[0]}, {2, homes[1]}, {2, homes[2]}, {3, o}})));
  cases.fault("piece-order/at-home-twice", with_homes(o, o));
  cases.fault("piece-order/cells-in-turns", built(with_pieces({{1, o}, {2, o}, {1, o}, {2, o}}, 2)));
  cases.faults("piece-order/cells-changed-places", built(with_pieces({{2, o}, {1, o}, {3, o}})));
  cases.faults("piece-order/last-cells-changed-places", built(with_pieces({{1, o}, {3, o}, {2, o}})));
  cases.fault("piece-order/a-cell-once-more", built(with_pieces({{1, o}, {2, o}, {3, o}, {1, o}})));
  cases.faults("piece-order/all-descending", built(with_pieces({{3, o}, {2, o}, {1, o}})));
  cases.fault("piece-order/all-the-same", built(with_pieces({{1, o}, {1, o}, {1, o}}, 1)));

  constexpr Home before = {-1, 0, 0};
  cases.fault("cell-without-piece/first", built(with_pieces({{2, before}, {2, o}, {3, o}})));
  cases.fault("cell-without-piece/second", built(with_pieces({{1, before}, {1, o}, {3, o}})));
  cases.fault("cell-without-piece/last", built(with_pieces({{1, o}, {2, before}, {2, o}})));
  cases.fault("cell-without-piece/all-but-the-last",
              built(with_pieces({{3, {-2, 0, 0}}, {3, before}, {3, o}})));
  cases.fault("cell-without-piece/all-but-the-first",
              built(with_pieces({{1, {-2, 0, 0}}, {1, before}, {1, o}})));
}

void add_id_cases(CaseList& cases) {
  for (std::size_t v = 0; v < 64; v += 9)
    cases.fault("voxel-id/4-of-3-at-" + to_string(v), with(tiny(), kTileChunk, kIdsAt + v, 4, 1));
  for (const unsigned id : {5u, 127u, 128u, 255u})
    cases.fault("voxel-id/" + to_string(id) + "-of-3", with(tiny(), kTileChunk, kIdsAt + 21, id, 1));
  cases.fault("voxel-id/all", edited(tiny(), kTileChunk, [](Bytes& tile) {
                std::fill(tile.begin() + kIdsAt, tile.end(), std::byte{0xff});
              }));
  TestFile wide = TestFile::of(many_cells_object(256));
  wide.chunks.pop_back();
  const std::size_t ids = 64 + 256 * kPieceBytes;
  for (const unsigned id : {257u, 512u, 0x8001u}) {
    cases.fault("voxel-id/" + to_string(id) + "-of-256", with(wide, kTileChunk, ids + 2 * 255, id, 2));
    cases.fault("voxel-id/" + to_string(id) + "-of-256-first", with(wide, kTileChunk, ids, id, 2));
  }
  TestFile full = TestFile::of(many_cells_object(254));
  full.chunks.pop_back();
  cases.fault("voxel-id/255-of-254",
              with(full, kTileChunk, full.chunk(kTileChunk).stored.size() - 1, 255, 1));

  const auto replaced = [](std::uint8_t from, std::uint8_t to) {
    return edited(tiny(), kTileChunk, [&](Bytes& tile) {
      std::replace(tile.begin() + kIdsAt, tile.end(), std::byte{from}, std::byte{to});
    });
  };
  for (std::uint8_t id = 1; id <= 3; ++id) {
    for (std::uint8_t to = 0; to <= 3; ++to)
      if (to != id)
        cases.fault("piece-without-voxel/" + to_string(id) + "-is-" + to_string(to), replaced(id, to));
  }
  cases.fault("piece-without-voxel/all", edited(tiny(), kTileChunk, [](Bytes& tile) {
                std::fill(tile.begin() + kIdsAt, tile.end(), std::byte{0});
              }));
  cases.fault("piece-without-voxel/last-of-256", with(wide, kTileChunk, ids + 2 * 255, 0, 2));
  cases.fault("piece-without-voxel/first-of-256", with(wide, kTileChunk, ids, 2, 2));
}

void add_home_cases(CaseList& cases) {
  constexpr std::array<std::int8_t, 3> o = {0, 0, 0};
  // Cell 2: a piece that is before the home along an axis lies behind in the tile, and the reverse.
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    for (const int by : {-128, -1, 1, 127}) {
      std::array<std::int8_t, 3> home = o;
      home[a] = std::int8_t(by);
      // The tile that holds the piece is before the home tile if `home` is above zero.
      const bool before = by > 0;
      const auto first = by < 0 ? home : o, second = by < 0 ? o : home;
      const std::string name = axis + (by < 0 ? "-minus-" : "-") + to_string(by < 0 ? -by : by);
      if (before)
        cases.fault("cell-home/" + name, with_homes(first, second));
      else
        cases.valid("tile/home-" + name, "4.2", with_homes(first, second));
      // A cell of one piece must be at home.
      cases.fault("cell-home/alone-" + name, built(with_pieces({{1, o}, {2, home}, {3, o}})));
    }
  }
  // z counts for more than y, and y for more than x.
  cases.fault("cell-home/z-before-x", built(with_pieces({{1, o}, {2, o}, {2, {-5, 0, 1}}, {3, o}})));
  cases.fault("cell-home/z-before-y", built(with_pieces({{1, o}, {2, o}, {2, {0, -5, 1}}, {3, o}})));
  cases.fault("cell-home/y-before-x", built(with_pieces({{1, o}, {2, o}, {2, {-5, 1, 0}}, {3, o}})));
  cases.valid("tile/home-x-after-z", "4.2", built(with_pieces({{1, o}, {2, {5, 0, -1}}, {2, o}, {3, o}})));
  cases.valid("tile/home-x-after-y", "4.2", built(with_pieces({{1, o}, {2, {5, -1, 0}}, {2, o}, {3, o}})));
  cases.valid("tile/home-y-after-z", "4.2", built(with_pieces({{1, o}, {2, {0, 5, -1}}, {2, o}, {3, o}})));
  cases.fault("cell-home/of-the-first", built(with_pieces({{1, {1, 0, 0}}, {2, o}, {3, o}})));
  cases.fault("cell-home/of-the-last", built(with_pieces({{1, o}, {2, o}, {3, {-1, 0, 0}}})));
  cases.fault("cell-home/of-all", built(with_pieces({{1, {1, 0, 0}}, {2, {1, 0, 0}}, {3, {1, 0, 0}}})));
  cases.fault("cell-home/without-a-piece-at-home", with_homes({-1, 0, 0}, {1, 0, 0}));
  cases.fault("cell-home/first-of-three", built(with_pieces({{1, {-1, 0, 0}}, {1, o}, {1, {1, 0, 0}}}, 1)));
  // Only where the piece's first voxel is decides, not where its others are.
  CellObject later = with_pieces({{1, {0, 0, -1}}, {1, o}}, 1);
  later.tile.voxel_ids.assign(64, 0);
  later.tile.voxel_ids[0] = 1;
  later.tile.voxel_ids[63] = 2;
  cases.valid("tile/home-of-a-last-voxel", "4.2", built(later));
  std::swap(later.tile.voxel_ids[0], later.tile.voxel_ids[63]);
  later.tile.pieces = {{1, o}, {1, {0, 0, 1}}};
  cases.fault("cell-home/of-a-last-voxel", built(later));
}

}  // namespace

void add_piece_cases(CaseList& cases) {
  add_piece_cases_of_rows(cases);
  add_id_cases(cases);
  add_home_cases(cases);
}

}  // namespace mesocell::test
