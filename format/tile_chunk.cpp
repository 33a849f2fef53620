#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>
#include <tuple>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::uint64_t kHeaderFieldBytes = 24;
constexpr std::uint64_t kPieceBytes = 8;
constexpr std::uint32_t kNoVoxel = 0xffffffff;
/// A piece costs its row and, while it is checked, the index of its first voxel; the same on every machine,
/// so that limits are.
constexpr std::uint64_t kPieceCost = 10;
static_assert(sizeof(Piece) + sizeof(std::uint32_t) <= kPieceCost);

std::uint64_t piece_at(std::uint64_t index) { return kPartAlignment + index * kPieceBytes; }
/// Where the ids begin.
std::uint64_t ids_at(std::uint64_t piece_count) { return aligned_part(piece_at(piece_count)); }

std::tuple<int, int, int, int> sort_key(const Piece& p) { return {p.cell, p.home[2], p.home[1], p.home[0]}; }

/// The fixed fields; false if the maps' sizes do not follow from them.
bool decode_header(const ChunkPayload& chunk, ByteReader& in, TileMap& tile, std::uint32_t& piece_count,
                   IssueSink& sink) {
  if (!check_payload_header(chunk, sink)) return false;
  for (std::uint32_t& r : tile.resolution) r = in.u32();
  tile.cell_count = in.u32();
  piece_count = in.u32();
  tile.id_bytes = in.u32();
  in.skip(kPartAlignment - kHeaderFieldBytes);
  check_payload_zeros(chunk, kHeaderFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  const std::uint64_t counts_errors_before = sink.errors();
  for (std::size_t a = 0; a < 3; ++a) {
    if (tile.resolution[a] < kMinResolution || tile.resolution[a] > kMaxResolution)
      add_issue(sink, IssueId::kTileResolution, chunk, 4 * a, to_string(tile.resolution[a]));
  }
  if (tile.cell_count == 0 || tile.cell_count > kMaxCells)
    add_issue(sink, IssueId::kTileCellCount, chunk, 12, to_string(tile.cell_count));
  if (sink.errors() != counts_errors_before) return false;

  if (piece_count < tile.cell_count || piece_count > tile.voxel_count()) {
    add_issue(sink, IssueId::kTilePieceCount, chunk, 16,
              to_string(piece_count) + " pieces, " + to_string(tile.cell_count) + " cells, " +
                  to_string(tile.voxel_count()) + " voxels");
    return false;
  }
  if (tile.id_bytes != TileMap::id_bytes_for(piece_count)) {
    add_issue(sink, IssueId::kTileIdBytes, chunk, 20,
              to_string(tile.id_bytes) + " bytes for " + to_string(piece_count) + " pieces");
    return false;
  }
  const std::uint64_t expected = ids_at(piece_count) + tile.voxel_count() * tile.id_bytes;
  if (!check_payload_size(chunk, expected, sink) && chunk.bytes.size() < expected) return false;
  check_payload_zeros(chunk, piece_at(piece_count), ids_at(piece_count), IssueId::kPayloadPadding, sink);
  return true;
}

void decode_pieces(const ChunkPayload& chunk, ByteReader& in, std::uint32_t piece_count, TileMap& tile,
                   IssueSink& sink) {
  tile.pieces.resize(piece_count);
  std::uint32_t last_cell = 0;
  for (std::size_t i = 0; i < piece_count && !sink.stopped(); ++i) {
    Piece& piece = tile.pieces[i];
    piece.cell = in.u16();
    for (std::int8_t& h : piece.home) h = static_cast<std::int8_t>(in.u8());
    const auto reserved = in.take(3);
    if ((piece.cell == 0 || piece.cell > tile.cell_count) && sink.wants(IssueId::kPieceCell))
      add_issue(sink, IssueId::kPieceCell, chunk, piece_at(i),
                "piece " + to_string(i + 1) + ", cell " + to_string(piece.cell));
    if (const std::size_t at = first_nonzero(reserved); at < reserved.size())
      add_issue(sink, IssueId::kPieceReserved, chunk, piece_at(i) + 5 + at);
    if (i > 0 && !(sort_key(tile.pieces[i - 1]) < sort_key(piece))) {
      if (sink.wants(IssueId::kPieceOrder))
        add_issue(sink, IssueId::kPieceOrder, chunk, piece_at(i), "piece " + to_string(i + 1));
    } else if (piece.cell > last_cell + 1 && piece.cell <= tile.cell_count) {
      add_issue(sink, IssueId::kCellWithoutPiece, chunk, piece_at(i), "cell " + to_string(last_cell + 1));
    }
    last_cell = std::max<std::uint32_t>(last_cell, piece.cell);
  }
  if (last_cell < tile.cell_count)
    add_issue(sink, IssueId::kCellWithoutPiece, chunk, piece_at(piece_count),
              "cell " + to_string(last_cell + 1));
}

/// Checks the ids and returns each piece's first voxel in storage order.
std::vector<std::uint32_t> first_voxels(const ChunkPayload& chunk, const TileMap& tile, IssueSink& sink) {
  const auto piece_count = static_cast<std::uint32_t>(tile.pieces.size());
  std::vector<std::uint32_t> first(std::size_t{piece_count} + 1, kNoVoxel);
  const std::uint64_t voxels = tile.voxel_count();
  for (std::uint64_t v = 0; v < voxels; ++v) {
    const std::uint32_t id = tile.id(v);
    if (id > piece_count) {
      // A fault in every voxel is told in one message, or the validator would take minutes over it.
      const std::uint64_t at = ids_at(piece_count) + v * tile.id_bytes;
      add_issue(sink, IssueId::kVoxelId, chunk, at, "voxel " + to_string(v) + " has id " + to_string(id));
      break;
    }
    if (first[id] == kNoVoxel) first[id] = static_cast<std::uint32_t>(v);
  }
  return first;
}

/// The home rule: the first voxel of an instance, its pieces put together, is in a piece with home (0,0,0).
void check_homes(const ChunkPayload& chunk, const TileMap& tile, const std::vector<std::uint32_t>& first,
                 IssueSink& sink) {
  using Position = std::tuple<std::int64_t, std::int64_t, std::int64_t>;  // z, y, x of the home tile
  const auto position = [&](std::size_t piece) {
    const std::uint32_t v = first[piece + 1];
    const Index3& r = tile.resolution;
    const auto& home = tile.pieces[piece].home;
    const std::int64_t x = v % r[0], y = v / r[0] % r[1], z = v / r[0] / r[1];
    return Position{z - std::int64_t{r[2]} * home[2], y - std::int64_t{r[1]} * home[1],
                    x - std::int64_t{r[0]} * home[0]};
  };
  for (std::size_t i = 0; i < tile.pieces.size() && !sink.stopped();) {
    const std::uint32_t cell = tile.pieces[i].cell;
    std::size_t best = i;
    std::size_t end = i;
    for (; end < tile.pieces.size() && tile.pieces[end].cell == cell; ++end)
      if (position(end) < position(best)) best = end;
    if (tile.pieces[best].home != std::array<std::int8_t, 3>{} && sink.wants(IssueId::kCellHome))
      add_issue(sink, IssueId::kCellHome, chunk, piece_at(best), "cell " + to_string(cell));
    i = end;
  }
}

}  // namespace

std::vector<std::byte> encode_tile(const TileMap& tile) {
  assert(tile.voxel_ids.size() == tile.voxel_count() * tile.id_bytes);
  assert(tile.id_bytes == TileMap::id_bytes_for(tile.pieces.size()));
  ByteWriter out;
  out.reserve(ids_at(tile.pieces.size()) + tile.voxel_ids.size());
  for (const std::uint32_t r : tile.resolution) out.u32(r);
  out.u32(tile.cell_count);
  out.u32(static_cast<std::uint32_t>(tile.pieces.size()));
  out.u32(tile.id_bytes);
  out.pad_to(kPartAlignment);
  for (const Piece& piece : tile.pieces) {
    out.u16(piece.cell);
    for (const std::int8_t h : piece.home) out.u8(static_cast<std::uint8_t>(h));
    out.zeros(3);
  }
  out.pad_to(kPartAlignment);
  out.append(std::as_bytes(std::span(tile.voxel_ids)));
  return out.release();
}

std::optional<TileMap> decode_tile(const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  ByteReader in(chunk.bytes);
  TileMap tile;
  std::uint32_t piece_count = 0;
  if (!decode_header(chunk, in, tile, piece_count, sink)) return std::nullopt;
  if (sink.stopped() || !budget.charge(std::uint64_t{piece_count} + 1, kPieceCost) ||
      !budget.charge(tile.voxel_count(), tile.id_bytes)) {
    if (!sink.stopped()) sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for the tile");
    return std::nullopt;
  }
  decode_pieces(chunk, in, piece_count, tile, sink);
  if (sink.stopped()) return std::nullopt;
  const bool pieces_ok = sink.errors() == errors_before;

  const auto ids = slice(chunk.bytes, ids_at(piece_count), tile.voxel_count() * tile.id_bytes);
  tile.voxel_ids.resize(ids.size());
  std::memcpy(tile.voxel_ids.data(), ids.data(), ids.size());
  const std::vector<std::uint32_t> first = first_voxels(chunk, tile, sink);
  if (sink.stopped()) return std::nullopt;
  const bool ids_ok = pieces_ok && sink.errors() == errors_before;
  if (ids_ok) {
    for (std::size_t i = 0; i < piece_count; ++i) {
      if (first[i + 1] == kNoVoxel && sink.wants(IssueId::kPieceWithoutVoxel))
        add_issue(sink, IssueId::kPieceWithoutVoxel, chunk, piece_at(i), "piece " + to_string(i + 1));
    }
  }
  if (sink.errors() == errors_before) check_homes(chunk, tile, first, sink);
  if (sink.errors() != errors_before) return std::nullopt;
  return tile;
}

}  // namespace mesocell
