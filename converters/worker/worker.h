#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// What a worker may take. Beyond it the worker is ended.
struct WorkerLimits {
  std::uint64_t max_memory_bytes = std::uint64_t{8} << 30;  ///< address space; not in sanitized builds
  double max_seconds = 600;                                 ///< of processor time
  std::uint64_t max_reply_bytes = std::uint64_t{4} << 30;
};

/// Runs a worker, a program of its own for a library that can crash, hang or take all memory on a hostile
/// file: so the command survives it, and pays for loading the library only where it is used. The program
/// is found where modules are, see load_module().
/// - `name`: "mesocell_vdb_worker"
/// - `request`: what its handler is given, see serve_request()
/// - `subject`: what the worker reads, for messages: "the volume"
/// - returns the handler's reply; it is to be checked like any untrusted bytes, as the worker may have been
///   led astray by what it read
/// Errors: the handler's; kInvalidInput (it crashed), kLimit (time, memory, size of the reply), kCancelled,
/// kOutput (the program is not there). Thread safety: safe, also beside other threads.
[[nodiscard]] Result<std::vector<std::byte>> run_worker(const std::string& name,
                                                        std::span<const std::byte> request,
                                                        const std::string& subject,
                                                        const WorkerLimits& limits = {},
                                                        const Progress* progress = nullptr);

}  // namespace mesocell
