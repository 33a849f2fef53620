#include <map>
#include <set>
#include <string>

#include "tests/format/mutations.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

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
