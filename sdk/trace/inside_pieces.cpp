#include "sdk/trace/inside_pieces.h"

#include <algorithm>
#include <array>

namespace mesocell {

InsidePieces::InsidePieces(const TileMap& tile, const MembershipMap& membership) {
  const std::array<std::int64_t, 3> tiles{membership.tiles[0], membership.tiles[1], membership.tiles[2]};
  const auto index = [&](const std::array<std::int64_t, 3>& t) {
    return std::uint64_t(t[0] + tiles[0] * (t[1] + tiles[1] * t[2]));
  };
  entries_.resize(std::size_t(tiles[0] * tiles[1] * tiles[2]));
  set_words_ = tile.pieces.size() / 64 + 1;
  std::vector<std::uint64_t> set(set_words_);
  std::uint32_t sets = 0;
  std::array<std::int64_t, 3> t{};
  for (t[2] = 0; t[2] < tiles[2]; ++t[2])
    for (t[1] = 0; t[1] < tiles[1]; ++t[1])
      for (t[0] = 0; t[0] < tiles[0]; ++t[0]) {
        std::fill(set.begin(), set.end(), 0);
        std::size_t count = 0;
        for (std::size_t k = 0; k < tile.pieces.size(); ++k) {
          const Piece& p = tile.pieces[k];
          const std::array<std::int64_t, 3> home{t[0] + p.home[0], t[1] + p.home[1], t[2] + p.home[2]};
          bool in = true;
          for (std::size_t a = 0; a < 3; ++a) in = in && home[a] >= 0 && home[a] < tiles[a];
          if (!in || membership.tag(index(home), p.cell) != Tag::kInside) continue;
          set[(k + 1) / 64] |= std::uint64_t{1} << ((k + 1) % 64);
          ++count;
        }
        std::uint32_t& entry = entries_[index(t)];
        entry = count == 0 ? kNone : count == tile.pieces.size() ? kAll : kFirstSet + sets++;
        if (entry >= kFirstSet) sets_.insert(sets_.end(), set.begin(), set.end());
      }
}

}  // namespace mesocell
