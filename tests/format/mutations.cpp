#include "tests/format/mutations.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "format/cell_object_chunks.h"

namespace mesocell::test {
namespace {

/// A number that finds off-by-one and overflow faults.
std::uint64_t interesting(Rng& rng, std::uint64_t now) {
  const std::uint64_t values[] = {0,          1,          2,          3,
                                  4,          64,         255,        256,
                                  65535,      65536,      0x3fffffff, 0x40000000,
                                  0x7fffffff, 0x80000000, 0xffffffff, ~std::uint64_t{0},
                                  now + 1,    now - 1,    now * 2,    now ^ std::uint64_t{1} << rng.below(64),
                                  rng.next()};
  return values[rng.below(std::size(values))];
}

}  // namespace

void mutate_bytes(Rng& rng, Bytes& bytes, std::size_t from, std::size_t to) {
  if (to <= from) return;
  const std::size_t at = from + rng.below(std::uint32_t(to - from));
  switch (rng.below(5)) {
    case 0:
      bytes[at] ^= std::byte(1u << rng.below(8));
      break;
    case 1:
      bytes[at] = std::byte(rng.below(256));
      break;
    case 2: {  // swap two rows of eight
      const std::size_t other = from + rng.below(std::uint32_t(to - from));
      for (std::size_t i = 0; i < 8 && at + i < to && other + i < to; ++i)
        std::swap(bytes[at + i], bytes[other + i]);
      break;
    }
    default: {
      const unsigned count = rng.below(2) == 0 ? 4 : 8;
      const std::size_t aligned = at / count * count;
      if (aligned < from || aligned + count > to) break;
      put(bytes, aligned, interesting(rng, get(bytes, aligned, count)), count);
      break;
    }
  }
}

void mutate_payload(Rng& rng, TestChunk& chunk) {
  Bytes& bytes = chunk.stored;
  switch (rng.below(12)) {
    case 0:
      bytes.resize(rng.below(std::uint32_t(bytes.size()) + 1));
      break;
    case 1:
      bytes.resize(bytes.size() + 1 + rng.below(70));
      break;
    case 2:
    case 3:
    case 4:
    case 5:
      mutate_bytes(rng, bytes, 0, std::min<std::size_t>(bytes.size(), 48));
      break;
    default:
      mutate_bytes(rng, bytes, 0, bytes.size());
      break;
  }
  chunk.decoded_bytes = bytes.size();
}

void mutate_deep(Rng& rng, TestFile& parts) {
  const auto any = [&](Bytes& bytes, std::size_t from, std::uint32_t range) {
    if (bytes.size() > from)
      bytes[from + rng.below(std::uint32_t(bytes.size() - from))] = std::byte(rng.below(range));
  };
  switch (rng.below(7)) {
    case 0:
      any(parts.chunk(kTileChunk).stored, 64, 6);
      break;  // pieces, ids
    case 1:
      any(parts.chunk(kMembershipChunk).stored, 64, 256);
      break;   // states, ranks, tags
    case 2: {  // one voxel takes another's id
      Bytes& tile = parts.chunk(kTileChunk).stored;
      if (tile.size() < 64 || get(tile, 16) >= (tile.size() - 64) / 8) break;
      const std::size_t ids = (64 + 8 * std::size_t(get(tile, 16)) + 63) / 64 * 64;
      if (ids >= tile.size()) break;
      const std::size_t n = tile.size() - ids;
      tile[ids + rng.below(std::uint32_t(n))] = tile[ids + rng.below(std::uint32_t(n))];
      break;
    }
    case 3:
      any(parts.chunks.back().stored, 0, 256);
      break;
    case 4: {  // a byte of a map, or its header
      TestChunk& map = parts.chunks[rng.below(std::uint32_t(parts.chunks.size()))];
      if ((map.flags & 1) == 0) any(map.stored, 0, 2 + rng.below(255));
      break;
    }
    case 5: {  // two bytes of SCOL change places, of masks mostly, whose bits stay as many
      for (TestChunk& chunk : parts.chunks) {
        if (chunk.type != kSurfaceColorChunk || chunk.stored.size() <= 64) continue;
        const std::uint32_t n = std::uint32_t(chunk.stored.size() - 64);
        std::swap(chunk.stored[64 + rng.below(n)], chunk.stored[64 + rng.below(n)]);
      }
      break;
    }
    default: {  // two tags change places
      Bytes& memb = parts.chunk(kMembershipChunk).stored;
      if (memb.size() < 64) break;
      const std::uint64_t tag_bytes = get(memb, 32) * ((get(memb, 4) + 3) / 4);
      const std::size_t n = std::size_t(std::min<std::uint64_t>(tag_bytes, memb.size() - 64)),
                        tags = memb.size() - n;
      if (n > 0)
        std::swap(memb[tags + rng.below(std::uint32_t(n))], memb[tags + rng.below(std::uint32_t(n))]);
      break;
    }
  }
}

void fix_counts(TestFile& parts) {
  Bytes& memb = parts.chunk(kMembershipChunk).stored;
  const Bytes& grid_bytes = parts.chunk(kGridChunk).stored;
  IssueSink sink = IssueSink::first_error();
  const auto grid = decode_grid({kGridChunk, grid_bytes}, ReadLimits{1 << 24, 1 << 24, 1 << 20}, sink);
  if (!grid || memb.size() < 64) return;
  const MembershipHeader header = read_membership_header(memb);
  const std::uint64_t tile_count = grid->tile_count();
  const MembershipLayout layout = MembershipLayout::of(tile_count, header.cell_count, header.mixed_count);
  if (header.cell_count == 0 || header.cell_count > kMaxCells || layout.bytes != memb.size()) return;
  std::array<std::uint64_t, 4> counts{};  // by tag: outside, inside, intersected, none
  const auto pair = [&](std::uint64_t begin, std::uint64_t i) {
    return std::size_t(get(memb, std::size_t(begin + i / 4), 1) >> 2 * (i % 4) & 3);
  };
  for (std::uint64_t t = 0; t < tile_count; ++t)
    if (const std::size_t state = pair(layout.states_at, t); state < 3) counts[state] += header.cell_count;
  for (std::uint64_t m = 0; m < header.mixed_count; ++m)
    for (std::uint64_t c = 0; c < header.cell_count; ++c)
      ++counts[pair(layout.tags_at + m * layout.tile_tag_bytes, c)];
  put(memb, 8, counts[1], 8);
  put(memb, 16, counts[0], 8);
  put(memb, 24, counts[2], 8);
}

}  // namespace mesocell::test
