#include "format/tag_reader.h"

#include <array>
#include <bit>
#include <cassert>
#include <new>
#include <string>

#include "format/byte_reader.h"
#include "format/cell_object_chunks.h"
#include "format/chunk_reader.h"

namespace mesocell {

struct TagReader::State {
  GridLayout grid;
  MembershipHeader header;
  MembershipLayout layout;
  ChunkReader memb;

  [[nodiscard]] Error fault(IssueId id, std::uint64_t at, std::string detail) const {
    IssueSink sink = IssueSink::first_error();
    add_issue(sink, id, {memb.chunk().type, {}, memb.chunk().offset, false}, at, std::move(detail));
    return sink.first_error_as_result();
  }
};

TagReader::TagReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
TagReader::TagReader(TagReader&&) noexcept = default;
TagReader& TagReader::operator=(TagReader&&) noexcept = default;
TagReader::~TagReader() = default;

const GridLayout& TagReader::grid() const { return state_->grid; }
std::uint32_t TagReader::cell_count() const { return state_->header.cell_count; }

Result<TagReader> TagReader::open(ByteSource& source, std::size_t asset, const ReadLimits& limits) try {
  const auto scan = read_head(source, limits);
  if (!scan) return scan.error();
  if (asset >= scan->assets.size())
    return Error{ErrorCode::kUsage, "there is no asset " + std::to_string(asset) + " in the file"};
  IssueSink sink = IssueSink::first_error();
  if (!scan_asset(*scan, asset, sink) || sink.errors() > 0) return sink.first_error_as_result();
  if (scan->assets[asset].representation != kCellObjectRepresentation)
    return Error{ErrorCode::kUsage, "the asset is no cell object, so it has no tags"};

  std::array<std::byte, kPartAlignment> bytes{};
  const ChunkInfo& grid_chunk = scan->chunks[*scan->find(asset, kGridChunk)];
  const ChunkPayload grid_payload{kGridChunk, bytes, grid_chunk.offset, true};
  if (grid_chunk.decoded_bytes != bytes.size()) {
    add_issue(sink, IssueId::kPayloadTruncated, grid_payload, 0,
              std::to_string(grid_chunk.decoded_bytes) + " bytes");
    return sink.first_error_as_result();
  }
  if (Status status = ChunkReader(source, grid_chunk).read(0, bytes); !status) return status.error();
  const auto grid = decode_grid(grid_payload, limits, sink);
  if (!grid) return sink.first_error_as_result();

  const ChunkInfo& memb_chunk = scan->chunks[*scan->find(asset, kMembershipChunk)];
  auto state = std::make_unique<State>(State{*grid, {}, {}, ChunkReader(source, memb_chunk)});
  if (memb_chunk.decoded_bytes < bytes.size())
    return state->fault(IssueId::kPayloadTruncated, 0, std::to_string(memb_chunk.decoded_bytes) + " bytes");
  if (Status status = state->memb.read(0, bytes); !status) return status.error();
  state->header = read_membership_header(bytes);
  const std::uint32_t cells = state->header.cell_count;
  if (cells == 0 || cells > kMaxCells) return state->fault(IssueId::kMembCellCount, 4, std::to_string(cells));
  state->layout = MembershipLayout::of(grid->tile_count(), cells, state->header.mixed_count);
  if (memb_chunk.decoded_bytes != state->layout.bytes) {
    const bool is_short = memb_chunk.decoded_bytes < state->layout.bytes;
    return state->fault(is_short ? IssueId::kPayloadTruncated : IssueId::kPayloadTrailing, 0,
                        std::to_string(memb_chunk.decoded_bytes) + " instead of " +
                            std::to_string(state->layout.bytes) + " bytes");
  }
  return TagReader(std::move(state));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::vector<Tag>> TagReader::tags(const Index3& tile) try {
  State& s = *state_;
  for (std::size_t a = 0; a < 3; ++a) assert(tile[a] < s.grid.tiles[a]);
  const std::uint64_t index = s.grid.tile_index(tile[0], tile[1], tile[2]);
  // The page's states up to the tile's own.
  const std::uint64_t page = index / MembershipLayout::kPageTiles,
                      in_page = index % MembershipLayout::kPageTiles;
  std::array<std::byte, MembershipLayout::kPageTiles / 4> states{};
  const auto wanted = std::span(states).first(static_cast<std::size_t>(in_page / 4 + 1));
  const std::uint64_t page_at = s.layout.states_at + page * states.size();
  if (Status status = s.memb.read(page_at, wanted); !status) return status.error();
  const auto last = std::to_integer<std::uint32_t>(wanted.back());
  const std::uint32_t state = last >> (2 * (in_page % 4)) & 3u;
  std::vector<Tag> tags(s.header.cell_count, static_cast<Tag>(state % 3));
  if (state != 3) return tags;

  std::uint64_t before = 0;
  for (const std::byte b : wanted) {
    const auto four = std::to_integer<unsigned>(b);
    before += static_cast<unsigned>(std::popcount(four & four >> 1 & 0x55u));
  }
  // Those in the last byte that are not before the tile, with itself.
  for (std::uint64_t k = in_page % 4; k < 4; ++k) before -= (last >> (2 * k) & 3u) == 3;
  std::array<std::byte, 4> rank_bytes{};
  const std::uint64_t rank_at = s.layout.ranks_at + page * rank_bytes.size();
  if (Status status = s.memb.read(rank_at, rank_bytes); !status) return status.error();
  const std::uint64_t mixed = ByteReader(rank_bytes).u32() + before;
  if (mixed >= s.header.mixed_count)
    return s.fault(IssueId::kMembRank, rank_at,
                   "mixed tile " + std::to_string(mixed) + " of " + std::to_string(s.header.mixed_count));
  std::vector<std::byte> bits(static_cast<std::size_t>(s.layout.tile_tag_bytes));
  const std::uint64_t tags_at = s.layout.tags_at + mixed * bits.size();
  if (Status status = s.memb.read(tags_at, bits); !status) return status.error();
  for (std::size_t c = 0; c < tags.size(); ++c) {
    const auto tag = std::to_integer<std::uint32_t>(bits[c / 4]) >> (2 * (c % 4)) & 3u;
    if (tag == 3) return s.fault(IssueId::kMembTag, tags_at + c / 4, "cell " + std::to_string(c + 1));
    tags[c] = static_cast<Tag>(tag);
  }
  return tags;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace mesocell
