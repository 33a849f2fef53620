#pragma once

#include <cstdint>

/// Allocations that fail on purpose: operator new and malloc, which takes in those of zstd and of the
/// standard library. With sanitizers, whose malloc must stay, operator new alone.
namespace mesocell::test {

enum class Failing : bool { kOnce, kFromThenOn };

/// The `nth` allocation (from 0) of this thread from now on fails, or it and all after it.
void fail_allocation(std::uint64_t nth, Failing failing = Failing::kOnce);
/// No allocation fails any more. Returns whether one has failed.
bool stop_failing_allocations();
/// Blocks that are allocated now, by any thread.
[[nodiscard]] std::int64_t live_allocations();

}  // namespace mesocell::test
