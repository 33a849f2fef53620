#include "sdk/trace/inside_pieces.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <unordered_map>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

using Home = std::array<std::int64_t, 3>;

/// What the tags of a tile's own instances say of those that are INSIDE.
enum Inside : std::uint8_t { kNothing = 1, kEverything = 2, kSome = 3 };

Inside inside_of(const MembershipMap& membership, std::uint32_t entry) {
  if (entry >= MembershipMap::kFirstBlock) return kSome;
  return entry == std::uint32_t(Tag::kInside) && membership.cell_count > 0 ? kEverything : kNothing;
}

}  // namespace

InsidePieces::InsidePieces(const TileMap& tile, const MembershipMap& membership) {
  const std::array<std::int64_t, 3> tiles{membership.tiles[0], membership.tiles[1], membership.tiles[2]};
  const auto index = [&](const Home& t) { return std::uint64_t(t[0] + tiles[0] * (t[1] + tiles[1] * t[2])); };
  const auto in_grid = [&](const Home& t) {
    return t[0] >= 0 && t[1] >= 0 && t[2] >= 0 && t[0] < tiles[0] && t[1] < tiles[1] && t[2] < tiles[2];
  };
  std::set<Home> homes;
  for (const Piece& p : tile.pieces) homes.insert({p.home[0], p.home[1], p.home[2]});

  // Most tiles are told by whole tiles around them: those whose homes have nothing INSIDE, or everything.
  constexpr std::uint32_t kUnknown = 2;
  entries_.resize(std::size_t(tiles[0] * tiles[1] * tiles[2]));
  parallel_for(std::size_t(tiles[2]), 0, [&](std::size_t z, unsigned) {
    std::vector<std::uint8_t> seen(static_cast<std::size_t>(tiles[0]), 0);
    for (std::int64_t y = 0; y < tiles[1]; ++y) {
      std::fill(seen.begin(), seen.end(), 0);
      for (const Home& h : homes) {
        const Home from{0, y + h[1], std::int64_t(z) + h[2]};
        if (!in_grid(from)) {
          for (std::uint8_t& s : seen) s |= kNothing;
          continue;
        }
        const std::uint32_t* const row = membership.entries.data() + index(from);
        for (std::int64_t x = 0; x < tiles[0]; ++x) {
          const std::int64_t at = x + h[0];
          seen[std::size_t(x)] = std::uint8_t(
              seen[std::size_t(x)] | (at < 0 || at >= tiles[0] ? kNothing : inside_of(membership, row[at])));
        }
      }
      for (std::int64_t x = 0; x < tiles[0]; ++x) {
        const std::uint8_t s = seen[std::size_t(x)];
        entries_[index({x, y, std::int64_t(z)})] = s == kEverything ? kAll : s == kSome ? kUnknown : kNone;
      }
    }
  });

  set_words_ = tile.pieces.size() / 32 + 1;
  std::vector<std::uint32_t> set(set_words_);
  for (std::size_t k = 1; k <= tile.pieces.size(); ++k) set[k / 32] |= 1u << (k % 32);
  sets_ = set;
  const auto key = [&] { return std::string(reinterpret_cast<const char*>(set.data()), 4 * set_words_); };
  std::unordered_map<std::string, std::uint32_t> known{{key(), kAll}};
  Home t{};
  for (t[2] = 0; t[2] < tiles[2]; ++t[2])
    for (t[1] = 0; t[1] < tiles[1]; ++t[1])
      for (t[0] = 0; t[0] < tiles[0]; ++t[0]) {
        std::uint32_t& entry = entries_[index(t)];
        if (entry != kUnknown) continue;
        std::fill(set.begin(), set.end(), 0);
        bool any = false;
        for (std::size_t k = 0; k < tile.pieces.size(); ++k) {
          const Piece& p = tile.pieces[k];
          const Home home{t[0] + p.home[0], t[1] + p.home[1], t[2] + p.home[2]};
          if (!in_grid(home) || membership.tag(index(home), p.cell) != Tag::kInside) continue;
          set[(k + 1) / 32] |= 1u << ((k + 1) % 32);
          any = true;
        }
        entry = kNone;
        if (!any) continue;
        const auto [found, added] = known.try_emplace(key(), std::uint32_t(set_count() + 1));
        if (added) sets_.insert(sets_.end(), set.begin(), set.end());
        entry = found->second;
      }
}

}  // namespace mesocell
