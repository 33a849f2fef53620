#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "format/result.h"

namespace mesocell {

/// The main function of a worker: reads the request from standard input to its end, hands it to `handler`,
/// and writes what that returns to standard output. Exceptions become errors, std::bad_alloc is kLimit.
/// Returns the exit code. The library's own words on standard error are dropped.
[[nodiscard]] int serve_request(
    const std::function<Result<std::vector<std::byte>>(std::span<const std::byte> request)>& handler);

}  // namespace mesocell
