#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "format/result.h"

/// Digests of what a valid file holds, see README.md; each from what another part of the library makes.
namespace mesocell::test {

/// From the chunks as the container decodes them.
[[nodiscard]] Result<std::uint64_t> digest_of_chunks(std::span<const std::byte> file);
/// From the objects that the reader makes, encoded again.
[[nodiscard]] Result<std::uint64_t> digest_of_objects(std::span<const std::byte> file);

}  // namespace mesocell::test
