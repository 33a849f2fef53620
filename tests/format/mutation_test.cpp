#include <map>
#include <set>
#include <string>

#include "format/cell_object_chunks.h"
#include "sdk/core/rng.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

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

/// Changes what a chunk holds: mostly its first bytes, where the counts are.
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

/// Nearby faults that keep sizes right, so that the deepest checks are reached.
void mutate_deep(Rng& rng, TestFile& parts) {
  const auto any = [&](Bytes& bytes, std::size_t from, std::uint32_t range) {
    if (bytes.size() > from)
      bytes[from + rng.below(std::uint32_t(bytes.size() - from))] = std::byte(rng.below(range));
  };
  switch (rng.below(6)) {
    case 0:
      any(parts.chunk(kTileChunk).stored, 64, 6);
      break;  // pieces, ids
    case 1:
      any(parts.chunk(kMembershipChunk).stored, 64, 256);
      break;   // states, ranks, tags
    case 2: {  // one voxel takes another's id
      Bytes& tile = parts.chunk(kTileChunk).stored;
      const std::size_t ids = (64 + 8 * get(tile, 16) + 63) / 64 * 64, n = tile.size() - ids;
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
    default: {  // two tags change places
      Bytes& memb = parts.chunk(kMembershipChunk).stored;
      const std::size_t n = get(memb, 32) * ((get(memb, 4) + 3) / 4), tags = memb.size() - n;
      if (n > 0)
        std::swap(memb[tags + rng.below(std::uint32_t(n))], memb[tags + rng.below(std::uint32_t(n))]);
      break;
    }
  }
}

struct Tally {
  int valid = 0, invalid = 0;
  std::set<std::string> ids;
};

void check(const Bytes& file, Tally& tally) {
  const Verdicts v = verdicts(file);
  ++(v.reader ? tally.valid : tally.invalid);
  tally.ids.insert(v.issues.begin(), v.issues.end());
  if (v.agree) return;
  CAPTURE(v.why, v.reader_id, v.loader_text, v.issues);
  CHECK(v.agree);
}

}  // namespace

TEST_CASE("format: reader, loader and validator agree on files whose chunks were changed") {
  Rng rng(20261122);
  Tally tally;
  for (std::uint64_t base = 0; base < 100; ++base) {
    const TestFile original = TestFile::take_apart(encoded(random_small_object(1000 + base)));
    for (int i = 0; i < 250; ++i) {
      CAPTURE(base, i);
      TestFile parts = original;
      for (std::uint32_t k = 0, n = 1 + rng.below(3) / 2; k < n; ++k) {
        if (rng.below(2) == 0) {
          mutate_deep(rng, parts);
        } else {
          mutate_payload(rng, parts.chunks[rng.below(std::uint32_t(parts.chunks.size()))]);
          break;
        }
      }
      for (TestChunk& chunk : parts.chunks)
        if (rng.below(4) == 0) rng.below(2) == 0 ? compress(chunk) : split(chunk, 4096, rng.below(2) == 0);
      check(parts.build(), tally);
    }
  }
  CAPTURE(tally.valid, tally.invalid, tally.ids);
  // The mutations must reach both sides of the line and most of the checks behind the hashes.
  CHECK(tally.valid > 100);
  CHECK(tally.invalid > 5000);
  CHECK(tally.ids.size() > 25);
}

TEST_CASE("format: reader, loader and validator agree on files whose header or directory was changed") {
  Rng rng(22112026);
  Tally tally;
  for (std::uint64_t base = 0; base < 30; ++base) {
    const Bytes original = encoded(random_small_object(2000 + base));
    const std::size_t directory_end = entry_at(std::size_t(get(original, 24)));
    for (int i = 0; i < 200; ++i) {
      CAPTURE(base, i);
      Bytes file = original;
      for (std::uint32_t k = 0, n = 1 + rng.below(2); k < n; ++k) {
        const std::uint32_t where = rng.below(8);
        if (where == 0) {
          mutate_bytes(rng, file, 0, 56);
        } else if (where == 1) {
          mutate_bytes(rng, file, directory_end, file.size());
        } else {
          mutate_bytes(rng, file, 64, directory_end);
        }
      }
      rng.below(2) == 0 ? reseal_chunks(file) : reseal_directory(file);
      check(file, tally);
    }
  }
  CAPTURE(tally.valid, tally.invalid, tally.ids);
  CHECK(tally.invalid > 4000);
  CHECK(tally.ids.size() > 20);
}

TEST_CASE("format: reader, loader and validator agree on changed zstd frames") {
  Rng rng(3);
  Tally tally;
  for (std::uint64_t base = 0; base < 20; ++base) {
    TestFile original = TestFile::take_apart(encoded(random_small_object(3000 + base)));
    for (TestChunk& chunk : original.chunks) compress(chunk, 1 + int(base));
    for (int i = 0; i < 250; ++i) {
      CAPTURE(base, i);
      TestFile parts = original;
      TestChunk& chunk = parts.chunks[rng.below(std::uint32_t(parts.chunks.size()))];
      if (rng.below(3) == 0) {
        mutate_bytes(rng, chunk.stored, 0, std::min<std::size_t>(chunk.stored.size(), 12));
      } else if (rng.below(8) == 0) {
        chunk.stored.resize(rng.below(std::uint32_t(chunk.stored.size())));
      } else {
        mutate_bytes(rng, chunk.stored, 0, chunk.stored.size());
      }
      check(parts.build(), tally);
    }
  }
  CAPTURE(tally.valid, tally.invalid, tally.ids);
  CHECK(tally.invalid > 1000);
}
