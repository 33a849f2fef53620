#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::size_t kMembershipHeaderBytes = 40;
constexpr std::uint32_t kMixed = 3;

struct Header {
  std::uint32_t rule = 0;
  std::uint32_t cell_count = 0;
  InstanceCounts counts;
  std::uint32_t run_count = 0;
  std::uint32_t mixed_count = 0;
};

std::uint32_t run_state(std::uint32_t run) { return run & 3; }
std::uint32_t run_length(std::uint32_t run) { return run >> 2; }

/// The runs one by one and in sum; false if they do not say which tiles are mixed.
bool check_runs(const ChunkPayload& chunk, ByteReader in, const Header& header, const GridLayout* grid,
                IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  std::uint64_t covered = 0;
  std::uint64_t mixed = 0;
  std::uint32_t previous = 0;
  for (std::uint32_t i = 0; i < header.run_count && !sink.stopped(); ++i) {
    const std::size_t at = kMembershipHeaderBytes + std::size_t{i} * 4;
    const std::uint32_t run = in.u32();
    if (run_length(run) == 0 && sink.wants(IssueId::kMembRunLength))
      add_issue(sink, IssueId::kMembRunLength, chunk, at, "run " + to_string(i));
    if (i > 0 && run_state(run) == run_state(previous) && run_length(previous) != kMaxRun &&
        sink.wants(IssueId::kMembRunMerge))
      add_issue(sink, IssueId::kMembRunMerge, chunk, at, "run " + to_string(i));
    covered += run_length(run);
    if (run_state(run) == kMixed) mixed += run_length(run);
    previous = run;
  }
  if (sink.stopped()) return false;
  if (grid && covered != grid->tile_count())
    add_issue(sink, IssueId::kMembRunSum, chunk, 32,
              to_string(covered) + " instead of " + to_string(grid->tile_count()) + " tiles");
  if (mixed != header.mixed_count)
    add_issue(sink, IssueId::kMembMixedCount, chunk, 36,
              to_string(header.mixed_count) + " instead of " + to_string(mixed));
  return sink.errors() == errors_before;
}

/// The tags of the mixed tiles.
void check_blocks(const ChunkPayload& chunk, const MembershipMap& membership, std::size_t blocks_at,
                  IssueSink& sink) {
  const std::size_t block_bytes = membership.block_bytes();
  const unsigned used_in_last = (membership.cell_count - 1) % 4 + 1;
  const auto unused = static_cast<std::uint8_t>(0xffu << (2 * used_in_last) & 0xffu);
  for (std::size_t at = 0; at < membership.blocks.size() && !sink.stopped(); at += block_bytes) {
    const std::span block(membership.blocks.data() + at, block_bytes);
    // All four pairs of a byte at once: a pair is 3 where both its bits are set.
    bool bad_tag = false;
    for (const std::uint8_t b : block) bad_tag |= (b & b >> 1 & 0x55) != 0;
    const std::string where = "mixed tile " + to_string(at / block_bytes);
    if ((block.back() & unused) != 0) {
      if (sink.wants(IssueId::kMembUnusedBits))
        add_issue(sink, IssueId::kMembUnusedBits, chunk, blocks_at + at + block_bytes - 1, where);
    } else if (bad_tag) {
      if (sink.wants(IssueId::kMembTag)) add_issue(sink, IssueId::kMembTag, chunk, blocks_at + at, where);
    }
    const auto all_same = static_cast<std::uint8_t>((block[0] & 3u) * 0x55u);
    bool uniform = (block.back() & ~unused) == (all_same & ~unused);
    for (std::size_t i = 0; i + 1 < block_bytes && uniform; ++i) uniform = block[i] == all_same;
    if (uniform && sink.wants(IssueId::kMembUniform))
      add_issue(sink, IssueId::kMembUniform, chunk, blocks_at + at, where);
  }
}

}  // namespace

std::vector<std::byte> encode_membership(const MembershipMap& membership) {
  std::vector<std::uint32_t> runs;
  std::uint32_t mixed_count = 0;
  for (const std::uint32_t entry : membership.entries) {
    const std::uint32_t state = std::min(entry, kMixed);
    assert(state != kMixed || entry == MembershipMap::kFirstBlock + mixed_count);
    mixed_count += state == kMixed;
    if (!runs.empty() && run_state(runs.back()) == state && run_length(runs.back()) < kMaxRun) {
      runs.back() += 4;
    } else {
      runs.push_back(state | 4);
    }
  }
  assert(membership.blocks.size() == mixed_count * membership.block_bytes());

  const InstanceCounts counts = count_instances(membership);
  ByteWriter out;
  out.u32(static_cast<std::uint32_t>(membership.rule));
  out.u32(membership.cell_count);
  out.u64(counts.inside);
  out.u64(counts.outside);
  out.u64(counts.intersected);
  out.u32(static_cast<std::uint32_t>(runs.size()));
  out.u32(mixed_count);
  for (const std::uint32_t run : runs) out.u32(run);
  out.append(std::as_bytes(std::span(membership.blocks)));
  return out.release();
}

std::optional<MembershipMap> decode_membership(const ChunkPayload& chunk, const GridLayout* grid,
                                               const TileMap* tile, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  ByteReader in(chunk.bytes);
  if (in.remaining() < kMembershipHeaderBytes) {
    add_issue(sink, IssueId::kPayloadTruncated, chunk, in.remaining(), "the header has 40 bytes");
    return std::nullopt;
  }
  Header header;
  header.rule = in.u32();
  header.cell_count = in.u32();
  header.counts.inside = in.u64();
  header.counts.outside = in.u64();
  header.counts.intersected = in.u64();
  header.run_count = in.u32();
  header.mixed_count = in.u32();
  if (header.rule > static_cast<std::uint32_t>(MembershipRule::kConservative))
    add_issue(sink, IssueId::kMembRule, chunk, 0, to_string(header.rule));
  if (tile ? header.cell_count != tile->cell_count
           : header.cell_count == 0 || header.cell_count > kMaxCells) {
    add_issue(sink, IssueId::kMembCellCount, chunk, 4,
              to_string(header.cell_count) + (tile ? " and " + to_string(tile->cell_count) : ""));
    return std::nullopt;
  }
  MembershipMap membership;
  membership.rule = static_cast<MembershipRule>(header.rule);
  membership.cell_count = header.cell_count;
  const std::uint64_t block_bytes = membership.block_bytes();
  const std::uint64_t blocks_at = kMembershipHeaderBytes + std::uint64_t{header.run_count} * 4;
  const std::uint64_t expected = blocks_at + header.mixed_count * block_bytes;
  if (chunk.bytes.size() != expected) {
    const bool is_short = chunk.bytes.size() < expected;
    add_issue(sink, is_short ? IssueId::kPayloadTruncated : IssueId::kPayloadTrailing, chunk,
              is_short ? chunk.bytes.size() : static_cast<std::size_t>(expected),
              to_string(chunk.bytes.size()) + " instead of " + to_string(expected) + " bytes");
    if (is_short) return std::nullopt;
  }
  if (sink.stopped() || !check_runs(chunk, in, header, grid, sink) || !grid) return std::nullopt;
  membership.tiles = grid->tiles;
  const std::uint64_t tile_count = grid->tile_count();
  if (!budget.charge(tile_count, sizeof(std::uint32_t)) || !budget.charge(header.mixed_count, block_bytes)) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for the membership");
    return std::nullopt;
  }

  membership.entries.reserve(tile_count);
  std::uint32_t next_block = MembershipMap::kFirstBlock;
  for (std::uint32_t i = 0; i < header.run_count; ++i) {
    const std::uint32_t run = in.u32();
    if (run_state(run) != kMixed) {
      membership.entries.insert(membership.entries.end(), run_length(run), run_state(run));
      continue;
    }
    for (std::uint32_t k = 0; k < run_length(run); ++k) membership.entries.push_back(next_block++);
  }
  const auto blocks = in.take(header.mixed_count * block_bytes);
  membership.blocks.resize(blocks.size());
  if (!blocks.empty()) std::memcpy(membership.blocks.data(), blocks.data(), blocks.size());
  check_blocks(chunk, membership, blocks_at, sink);
  if (sink.errors() != errors_before) return std::nullopt;

  const InstanceCounts counts = count_instances(membership);
  if (!(counts == header.counts)) {
    add_issue(sink, IssueId::kMembCounts, chunk, 8,
              to_string(header.counts.inside) + ", " + to_string(header.counts.outside) + ", " +
                  to_string(header.counts.intersected) + " instead of " + to_string(counts.inside) + ", " +
                  to_string(counts.outside) + ", " + to_string(counts.intersected));
    return std::nullopt;
  }
  return membership;
}

}  // namespace mesocell
