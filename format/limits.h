#pragma once

#include <algorithm>
#include <cstdint>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// What a caller allows a reader to take. Every size is checked against these before memory is allocated;
/// a well-formed file that goes beyond one is refused with ErrorCode::kLimit. [spec 6]
struct ReadLimits {
  /// Largest file, bytes.
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;
  /// Sum over all chunks of their decoded bytes and over all maps of their bytes in memory. A reader holds no
  /// more than this at any time, but for the file itself and constants below 1 MiB.
  std::uint64_t max_decoded_bytes = std::uint64_t{1} << 33;
  /// Most tiles of a grid.
  std::uint64_t max_tiles = std::uint64_t{1} << 28;
};

/// Counts what a reader is about to allocate against ReadLimits::max_decoded_bytes, and against what one
/// object can have on this machine: what was charged fits in a std::size_t and in a vector.
class MemoryBudget {
 public:
  explicit MemoryBudget(const ReadLimits& limits)
      : left_(std::min<std::uint64_t>(limits.max_decoded_bytes, PTRDIFF_MAX)) {}
  /// Takes `count` × `bytes_each` from the budget; false, and nothing taken, if that is more than is left.
  [[nodiscard]] bool charge(std::uint64_t count, std::uint64_t bytes_each = 1) {
    if (count != 0 && bytes_each > left_ / count) return false;
    left_ -= count * bytes_each;
    return true;
  }
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  std::uint64_t left_;
};

}  // namespace mesocell
