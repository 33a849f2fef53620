#pragma once

#include <cstddef>

#include "sdk/core/rng.h"
#include "tests/format/test_file.h"

/// Random changes of files, for tests whose readers must agree on whatever comes out.
namespace mesocell::test {

/// Flips, replaces or swaps some bytes in from…to, or puts a number there that finds off-by-one and overflow
/// faults.
void mutate_bytes(Rng& rng, Bytes& bytes, std::size_t from, std::size_t to);

/// Changes what a raw chunk holds: its size, or bytes of it, mostly the first ones, where the counts are.
void mutate_payload(Rng& rng, TestChunk& chunk);

/// Nearby faults that keep sizes right, so that the deepest checks are reached. There must be TILE and MEMB,
/// and all chunks must be raw; they need not be valid.
void mutate_deep(Rng& rng, TestFile& parts);

/// Makes the counts in a raw MEMB what its states and tags say, so that a fault in a tag is not found by its
/// count. There must be MEMB; it need not be valid.
void fix_counts(TestFile& parts);

}  // namespace mesocell::test
