#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "format/api.h"
#include "sdk/core/progress.h"

namespace mesocell MESOCELL_API {

/// Number of threads to use: `requested`, or the machine's if 0.
[[nodiscard]] unsigned resolve_threads(unsigned requested);

/// Calls `body(i, worker)` for i in [0, count), each once, in any order, on `threads` threads (0: the
/// machine's); `worker` is in [0, threads). Results must not depend on the order: write to slots of `i`.
/// Returns false if cancelled, with some calls left out. An exception in `body` stops the loop and is thrown
/// to the caller.
bool parallel_for(std::size_t count, unsigned threads,
                  const std::function<void(std::size_t i, unsigned worker)>& body,
                  const Progress* progress = nullptr, std::string_view stage = {});

}  // namespace mesocell
