#pragma once

#include <cstdint>
#include <string>

#include "converters/stability/voxelizer.h"
#include "sdk/core/progress.h"

namespace mesocell {

enum class RunOutcome : std::uint8_t { kDone, kTooLong, kFailed };

/// What came of a method in a process of its own.
struct IsolatedRun {
  RunOutcome outcome = RunOutcome::kFailed;
  std::string message;             ///< of kFailed: what the method said, or how its process ended
  double seconds = 0;              ///< of the method alone, wall clock
  double cpu_seconds = 0;          ///< the same, of all processors together; 0 unless kDone
  std::uint64_t memory_bytes = 0;  ///< the most it had above what was there when it began; 0 unless kDone
};

/// Runs a method in a child process, which is killed after `max_seconds` of processor time, of all its
/// threads, or twenty times that by the clock, or when `progress` is cancelled; a crash is an outcome too.
/// `out` is cleared and holds what the method set. The method is prepared there, untimed. No other thread
/// of the caller may be running. Errors: kCancelled, kLimit (no process could be made).
[[nodiscard]] Result<IsolatedRun> run_isolated(const Voxelizer& method, const TriangleMesh& mesh,
                                               BitGrid& out, unsigned threads, double max_seconds,
                                               const Progress* progress);

}  // namespace mesocell
