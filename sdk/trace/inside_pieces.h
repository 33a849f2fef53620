#pragma once

#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"

namespace mesocell MESOCELL_API {

/// Which pieces of each tile are of INSIDE instances. Tiles with the same ones share a set. Thread safety:
/// const.
class InsidePieces {
 public:
  InsidePieces(const TileMap& tile, const MembershipMap& membership);

  /// What is known of a tile: kNone, kAll, or another set.
  [[nodiscard]] std::uint32_t entry(std::uint64_t tile) const { return entries_[tile]; }
  [[nodiscard]] const std::vector<std::uint32_t>& entries() const { return entries_; }
  static constexpr std::uint32_t kNone = 0, kAll = 1;

  /// Whether piece `id` (0: empty space) is INSIDE in a tile of this entry, which is not kNone.
  [[nodiscard]] bool has(std::uint32_t entry, std::uint32_t id) const {
    return sets_[std::size_t{entry - 1} * set_words_ + id / 32] >> (id % 32) & 1;
  }

  /// The sets of the entries from kAll on, a bit for each piece id, set_words() words each.
  [[nodiscard]] const std::vector<std::uint32_t>& sets() const { return sets_; }
  [[nodiscard]] std::size_t set_words() const { return set_words_; }
  [[nodiscard]] std::size_t set_count() const { return sets_.size() / set_words_; }

  [[nodiscard]] std::uint64_t memory_bytes() const {
    return (entries_.capacity() + sets_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  std::vector<std::uint32_t> entries_;
  std::vector<std::uint32_t> sets_;
  std::size_t set_words_ = 0;
};

}  // namespace mesocell
