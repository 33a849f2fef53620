#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "format/result.h"

namespace mesocell {

/// Reads a file whole. A FIFO or a device would be waited for or never end, so only plain files are read.
/// Errors: kUnreadable, kLimit.
[[nodiscard]] Result<std::vector<std::byte>> read_plain_file(const std::string& path,
                                                             std::uint64_t max_bytes);

}  // namespace mesocell
