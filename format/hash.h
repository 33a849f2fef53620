#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace mesocell {

/// XXH64 with seed 0: the hash of headers, directories and chunks. It finds damage, not malice. [spec 2.4]
[[nodiscard]] std::uint64_t hash64(std::span<const std::byte> bytes);

}  // namespace mesocell
