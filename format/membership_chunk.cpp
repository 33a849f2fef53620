#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::uint64_t kMembershipFieldBytes = 36;
constexpr std::uint32_t kMixed = 3;
constexpr std::uint64_t kRankBytes = 4;

/// The two bits of a tile.
std::uint32_t state_of(std::span<const std::byte> states, std::uint64_t tile) {
  return std::to_integer<std::uint32_t>(states[static_cast<std::size_t>(tile / 4)]) >> (2 * (tile % 4)) & 3u;
}

/// Mixed tiles of four states: pairs of which both bits are set.
unsigned count_mixed(std::byte states) {
  const auto b = std::to_integer<unsigned>(states);
  return static_cast<unsigned>(std::popcount(b & b >> 1 & 0x55u));
}

/// States and ranks; false if they do not say which tiles are mixed.
bool check_states(const ChunkPayload& chunk, const MembershipLayout& layout, std::uint64_t tile_count,
                  std::uint32_t mixed_count, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  const auto states = slice(chunk.bytes, layout.states_at, layout.ranks_at - layout.states_at);
  // What is after the last state, beginning with the rest of its byte.
  for (std::uint64_t t = tile_count; t < (tile_count + 3) / 4 * 4; ++t) {
    if (state_of(states, t) == 0) continue;
    add_issue(sink, IssueId::kMembUnusedBits, chunk, layout.states_at + t / 4, "after the last state");
    break;
  }
  check_payload_zeros(chunk, layout.states_at + (tile_count + 3) / 4, layout.ranks_at,
                      IssueId::kPayloadPadding, sink);
  const std::uint64_t pages = layout.page_count(tile_count);
  check_payload_zeros(chunk, layout.ranks_at + pages * kRankBytes, layout.tags_at, IssueId::kPayloadPadding,
                      sink);

  ByteReader ranks(slice(chunk.bytes, layout.ranks_at, pages * kRankBytes));
  std::uint64_t mixed = 0;
  for (std::uint64_t p = 0; p < pages && !sink.stopped(); ++p) {
    if (const std::uint32_t rank = ranks.u32(); rank != mixed && sink.wants(IssueId::kMembRank))
      add_issue(sink, IssueId::kMembRank, chunk, layout.ranks_at + p * kRankBytes,
                to_string(rank) + " instead of " + to_string(mixed));
    const std::uint64_t begin = p * MembershipLayout::kPageTiles / 4;
    const std::uint64_t end =
        std::min<std::uint64_t>(begin + MembershipLayout::kPageTiles / 4, states.size());
    for (std::uint64_t i = begin; i < end; ++i) mixed += count_mixed(states[static_cast<std::size_t>(i)]);
  }
  if (sink.stopped()) return false;
  if (mixed != mixed_count)
    add_issue(sink, IssueId::kMembMixedCount, chunk, 32,
              to_string(mixed_count) + " instead of " + to_string(mixed));
  return sink.errors() == errors_before;
}

/// The tags of the mixed tiles.
void check_blocks(const ChunkPayload& chunk, const MembershipMap& membership, std::uint64_t tags_at,
                  IssueSink& sink) {
  const std::size_t block_bytes = membership.block_bytes();
  const unsigned used_in_last = (membership.cell_count - 1) % 4 + 1;
  const auto unused = static_cast<std::uint8_t>(0xffu << (2 * used_in_last) & 0xffu);
  for (std::size_t at = 0; at < membership.blocks.size() && !sink.stopped(); at += block_bytes) {
    const std::span block(membership.blocks.data() + at, block_bytes);
    // All four pairs of a byte at once: a pair is 3 where both its bits are set.
    bool bad_tag = false;
    for (const std::uint8_t b : block) bad_tag |= (b & b >> 1 & 0x55) != 0;
    const auto where = [&] { return "mixed tile " + to_string(at / block_bytes); };
    if ((block.back() & unused) != 0) {
      if (sink.wants(IssueId::kMembUnusedBits))
        add_issue(sink, IssueId::kMembUnusedBits, chunk, tags_at + at + block_bytes - 1, where());
    } else if (bad_tag) {
      if (sink.wants(IssueId::kMembTag)) add_issue(sink, IssueId::kMembTag, chunk, tags_at + at, where());
    }
    const auto all_same = static_cast<std::uint8_t>((block[0] & 3u) * 0x55u);
    bool uniform = (block.back() & ~unused) == (all_same & ~unused);
    for (std::size_t i = 0; i + 1 < block_bytes && uniform; ++i) uniform = block[i] == all_same;
    if (uniform && sink.wants(IssueId::kMembUniform))
      add_issue(sink, IssueId::kMembUniform, chunk, tags_at + at, where());
  }
}

}  // namespace

MembershipHeader read_membership_header(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  MembershipHeader header;
  header.rule = in.u32();
  header.cell_count = in.u32();
  header.counts.inside = in.u64();
  header.counts.outside = in.u64();
  header.counts.intersected = in.u64();
  header.mixed_count = in.u32();
  return header;
}

MembershipLayout MembershipLayout::of(std::uint64_t tile_count, std::uint32_t cell_count,
                                      std::uint32_t mixed_count) {
  MembershipLayout layout;
  layout.states_at = kPartAlignment;
  layout.ranks_at = layout.states_at + aligned_part((tile_count + 3) / 4);
  layout.tags_at = layout.ranks_at + aligned_part(page_count(tile_count) * kRankBytes);
  layout.tile_tag_bytes = (std::uint64_t{cell_count} + 3) / 4;
  layout.bytes = layout.tags_at + mixed_count * layout.tile_tag_bytes;
  return layout;
}

std::vector<std::byte> encode_membership(const MembershipMap& membership) {
  const std::uint64_t tile_count = membership.entries.size();
  const auto mixed_count = static_cast<std::uint32_t>(
      std::count_if(membership.entries.begin(), membership.entries.end(),
                    [](std::uint32_t entry) { return entry >= MembershipMap::kFirstBlock; }));
  assert(membership.blocks.size() == mixed_count * membership.block_bytes());
  const MembershipLayout layout = MembershipLayout::of(tile_count, membership.cell_count, mixed_count);

  const InstanceCounts counts = count_instances(membership);
  ByteWriter out;
  out.reserve(layout.bytes);
  out.u32(static_cast<std::uint32_t>(membership.rule));
  out.u32(membership.cell_count);
  out.u64(counts.inside);
  out.u64(counts.outside);
  out.u64(counts.intersected);
  out.u32(mixed_count);
  out.pad_to(kPartAlignment);
  std::vector<std::uint32_t> ranks;
  std::uint32_t mixed = 0;
  unsigned four = 0;
  for (std::size_t t = 0; t < membership.entries.size(); ++t) {
    if (t % MembershipLayout::kPageTiles == 0) ranks.push_back(mixed);
    const std::uint32_t state = std::min(membership.entries[t], kMixed);
    assert(state != kMixed || membership.entries[t] == MembershipMap::kFirstBlock + mixed);
    mixed += state == kMixed;
    four |= state << (2 * (t % 4));
    if (t % 4 == 3 || t + 1 == membership.entries.size())
      out.u8(static_cast<std::uint8_t>(std::exchange(four, 0)));
  }
  out.pad_to(kPartAlignment);
  for (const std::uint32_t rank : ranks) out.u32(rank);
  out.pad_to(kPartAlignment);
  out.append(std::as_bytes(std::span(membership.blocks)));
  return out.release();
}

std::optional<MembershipMap> decode_membership(const ChunkPayload& chunk, const GridLayout* grid,
                                               const TileMap* tile, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_header(chunk, sink)) return std::nullopt;
  const MembershipHeader header = read_membership_header(chunk.bytes);
  if (header.rule > static_cast<std::uint32_t>(MembershipRule::kConservative))
    add_issue(sink, IssueId::kMembRule, chunk, 0, to_string(header.rule));
  check_payload_zeros(chunk, kMembershipFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  if (tile ? header.cell_count != tile->cell_count
           : header.cell_count == 0 || header.cell_count > kMaxCells) {
    add_issue(sink, IssueId::kMembCellCount, chunk, 4,
              to_string(header.cell_count) + (tile ? " and " + to_string(tile->cell_count) : ""));
    return std::nullopt;
  }
  if (!grid || sink.stopped()) return std::nullopt;
  const std::uint64_t tile_count = grid->tile_count();
  const MembershipLayout layout = MembershipLayout::of(tile_count, header.cell_count, header.mixed_count);
  if (!check_payload_size(chunk, layout.bytes, sink) && chunk.bytes.size() < layout.bytes)
    return std::nullopt;
  if (sink.stopped() || !check_states(chunk, layout, tile_count, header.mixed_count, sink))
    return std::nullopt;

  MembershipMap membership;
  membership.rule = static_cast<MembershipRule>(header.rule);
  membership.cell_count = header.cell_count;
  membership.tiles = grid->tiles;
  const std::uint64_t tag_bytes = header.mixed_count * layout.tile_tag_bytes;
  if (!budget.charge(tile_count, sizeof(std::uint32_t)) || !budget.charge(tag_bytes)) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for the membership");
    return std::nullopt;
  }
  membership.entries.resize(static_cast<std::size_t>(tile_count));
  const auto states = slice(chunk.bytes, layout.states_at, layout.ranks_at - layout.states_at);
  std::uint32_t next_block = MembershipMap::kFirstBlock;
  for (std::size_t t = 0; t < membership.entries.size(); ++t) {
    const std::uint32_t state = state_of(states, t);
    membership.entries[t] = state == kMixed ? next_block++ : state;
  }
  const auto tags = slice(chunk.bytes, layout.tags_at, tag_bytes);
  membership.blocks.resize(tags.size());
  if (!tags.empty()) std::memcpy(membership.blocks.data(), tags.data(), tags.size());
  check_blocks(chunk, membership, static_cast<std::size_t>(layout.tags_at), sink);
  if (sink.errors() != errors_before) return std::nullopt;

  const InstanceCounts counts = count_instances(membership);
  if (!(counts == header.counts)) {
    add_issue(sink, IssueId::kMembCounts, chunk, 8,
              to_string(header.counts.inside) + ", " + to_string(header.counts.outside) + ", " +
                  to_string(header.counts.intersected) + " instead of " + to_string(counts.inside) + ", " +
                  to_string(counts.outside) + ", " + to_string(counts.intersected));
    return std::nullopt;
  }
  if (counts.inside == 0) add_issue(sink, IssueId::kMembNothingInside, chunk, 8);
  return membership;
}

}  // namespace mesocell
