#include "sdk/membership/touch.h"

#include <algorithm>
#include <cmath>

namespace mesocell {

TouchFinder::TouchFinder(const TileMap& tile) : tile_(tile) {
  for (std::size_t a = 0; a < 3; ++a) blocks_[a] = (tile.resolution[a] + kBlock - 1) / kBlock;
  std::vector<std::uint32_t> found;
  first_.push_back(0);
  for (std::uint32_t bz = 0; bz < blocks_[2]; ++bz)
    for (std::uint32_t by = 0; by < blocks_[1]; ++by)
      for (std::uint32_t bx = 0; bx < blocks_[0]; ++bx) {
        found.clear();
        for (std::uint32_t z = bz * kBlock; z < std::min((bz + 1) * kBlock, tile.resolution[2]); ++z)
          for (std::uint32_t y = by * kBlock; y < std::min((by + 1) * kBlock, tile.resolution[1]); ++y)
            for (std::uint32_t x = bx * kBlock; x < std::min((bx + 1) * kBlock, tile.resolution[0]); ++x)
              if (const std::uint32_t id = tile.id(tile.voxel_index(x, y, z)); id != 0)
                if (found.empty() || found.back() != id) found.push_back(id);
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        ids_.insert(ids_.end(), found.begin(), found.end());
        first_.push_back(ids_.size());
      }
}

void TouchFinder::mark(const std::array<Vec3, 3>& t, const std::array<std::int64_t, 3>& corner,
                       std::span<std::uint8_t> pieces) const {
  // The voxels whose closed boxes meet the triangle's box, counted from the tile's corner.
  Index3 low{}, high{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double n = tile_.resolution[a];
    const double from = std::min({t[0][a], t[1][a], t[2][a]}) - double(corner[a]);
    const double to = std::max({t[0][a], t[1][a], t[2][a]}) - double(corner[a]);
    // Generous by a voxel, since the differences are rounded; the exact test decides.
    low[a] = std::uint32_t(std::clamp(std::ceil(from) - 2, 0.0, n));
    high[a] = std::uint32_t(std::clamp(std::floor(to) + 2, 0.0, n));
    if (low[a] >= high[a]) return;
  }
  const std::uint32_t k = kBlock;
  for (std::uint32_t bz = low[2] / k; bz * k < high[2]; ++bz)
    for (std::uint32_t by = low[1] / k; by * k < high[1]; ++by)
      for (std::uint32_t bx = low[0] / k; bx * k < high[0]; ++bx) {
        const std::size_t b = bx + std::size_t{blocks_[0]} * (by + std::size_t{blocks_[1]} * bz);
        const bool news = std::any_of(ids_.begin() + std::ptrdiff_t(first_[b]),
                                      ids_.begin() + std::ptrdiff_t(first_[b + 1]),
                                      [&](std::uint32_t id) { return pieces[id] != kTouched; });
        if (!news) continue;
        const Index3 l{std::max(low[0], bx * k), std::max(low[1], by * k), std::max(low[2], bz * k)};
        const Index3 h{std::min(high[0], (bx + 1) * k), std::min(high[1], (by + 1) * k),
                       std::min(high[2], (bz + 1) * k)};
        mark_block(t, corner, l, h, pieces);
      }
}

void TouchFinder::mark_block(const std::array<Vec3, 3>& t, const std::array<std::int64_t, 3>& corner,
                             const Index3& low, const Index3& high, std::span<std::uint8_t> pieces) const {
  const auto at = [&](const Index3& v) {
    return Vec3{double(corner[0] + v[0]), double(corner[1] + v[1]), double(corner[2] + v[2])};
  };
  if (!triangle_meets_box(t, at(low), at(high))) return;
  std::size_t longest = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (high[a] - low[a] > high[longest] - low[longest]) longest = a;
  if (high[longest] - low[longest] == 1) {
    pieces[tile_.id(tile_.voxel_index(low[0], low[1], low[2]))] = kTouched;
    return;
  }
  // Halves share a face of closed boxes, which both are tested with: so is the definition.
  const std::uint32_t middle = (low[longest] + high[longest]) / 2;
  Index3 split = high;
  split[longest] = middle;
  mark_block(t, corner, low, split, pieces);
  split = low;
  split[longest] = middle;
  mark_block(t, corner, split, high, pieces);
}

}  // namespace mesocell
