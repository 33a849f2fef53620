#pragma once

#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"

namespace mesocell MESOCELL_API {

/// Which pieces of each tile are of INSIDE instances. Thread safety: const.
class InsidePieces {
 public:
  InsidePieces(const TileMap& tile, const MembershipMap& membership);

  /// What is known of a tile: kNone, kAll, or a set.
  [[nodiscard]] std::uint32_t entry(std::uint64_t tile) const { return entries_[tile]; }
  [[nodiscard]] const std::vector<std::uint32_t>& entries() const { return entries_; }
  static constexpr std::uint32_t kNone = 0, kAll = 1;

  /// Whether piece `id` (0: empty space) is INSIDE in a tile of this entry, which is not kNone.
  [[nodiscard]] bool has(std::uint32_t entry, std::uint32_t id) const {
    if (entry == kAll) return id != 0;
    return sets_[std::size_t{entry - kFirstSet} * set_words_ + id / 64] >> (id % 64) & 1;
  }

  [[nodiscard]] std::uint64_t memory_bytes() const {
    return entries_.capacity() * sizeof(entries_[0]) + sets_.capacity() * sizeof(sets_[0]);
  }

 private:
  static constexpr std::uint32_t kFirstSet = 2;

  std::vector<std::uint32_t> entries_;
  /// Sets of piece ids, a bit each, set_words_ words a set.
  std::vector<std::uint64_t> sets_;
  std::size_t set_words_ = 0;
};

}  // namespace mesocell
