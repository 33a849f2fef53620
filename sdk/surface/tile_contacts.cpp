#include "sdk/surface/tile_contacts.h"

#include <algorithm>
#include <unordered_map>

namespace mesocell {
namespace {

class Counter {
 public:
  void add(std::uint32_t lower, std::uint32_t upper) {
    const std::uint64_t key = std::uint64_t{lower} << 32 | upper;
    // Neighbours in a row mostly touch the same pieces.
    if (key != key_ || !faces_) {
      key_ = key;
      faces_ = &counts_[key];
    }
    ++*faces_;
  }
  [[nodiscard]] std::vector<TileContacts::Contact> contacts() const {
    std::vector<TileContacts::Contact> out;
    out.reserve(counts_.size());
    for (const auto& [key, faces] : counts_)
      out.push_back({std::uint32_t(key >> 32), std::uint32_t(key), faces});
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
      return a.lower != b.lower ? a.lower < b.lower : a.upper < b.upper;
    });
    return out;
  }

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> counts_;
  std::uint64_t key_ = 0;
  std::uint64_t* faces_ = nullptr;
};

}  // namespace

TileContacts::TileContacts(const TileMap& tile) {
  const Index3& r = tile.resolution;
  const std::array<std::uint64_t, 3> stride{1, r[0], std::uint64_t{r[0]} * r[1]};
  Counter within;
  std::array<Counter, 3> across;
  std::uint64_t index = 0;
  std::array<std::uint32_t, 3> v{};
  for (v[2] = 0; v[2] < r[2]; ++v[2])
    for (v[1] = 0; v[1] < r[1]; ++v[1])
      for (v[0] = 0; v[0] < r[0]; ++v[0], ++index) {
        const std::uint32_t id = tile.id(index);
        for (std::size_t a = 0; a < 3; ++a) {
          const bool last = v[a] + 1 == r[a];
          const std::uint32_t next = tile.id(last ? index - (r[a] - 1) * stride[a] : index + stride[a]);
          if (last)
            across[a].add(id, next);
          else if (id != next)
            within.add(std::min(id, next), std::max(id, next));
        }
      }
  within_ = within.contacts();
  for (std::size_t a = 0; a < 3; ++a) across_[a] = across[a].contacts();
}

}  // namespace mesocell
