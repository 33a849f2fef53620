#include "sdk/trace/reach.h"

#include <algorithm>
#include <array>

namespace mesocell {
namespace {

constexpr std::uint8_t kFar = 255;

std::uint8_t farther(std::uint8_t d) { return d == kFar ? kFar : std::uint8_t(d + 1); }

/// One sweep of a two-pass distance transform: every row takes what its four predecessors and its own entries
/// offer.
class Sweep {
 public:
  Sweep(std::vector<std::uint8_t>& distance, const Index3& size)
      : distance_(distance), n_{size[0], size[1], size[2]}, best_(size[0]), spread_(size[0]) {}

  void run(std::int64_t direction) {
    for (std::int64_t k = 0; k < n_[2]; ++k)
      for (std::int64_t j = 0; j < n_[1]; ++j) {
        const std::int64_t z = direction > 0 ? k : n_[2] - 1 - k, y = direction > 0 ? j : n_[1] - 1 - j;
        sweep_row(y, z, direction);
      }
  }

 private:
  [[nodiscard]] std::uint8_t* row(std::int64_t y, std::int64_t z) {
    return y < 0 || z < 0 || y >= n_[1] || z >= n_[2] ? nullptr : distance_.data() + n_[0] * (y + n_[1] * z);
  }

  void sweep_row(std::int64_t y, std::int64_t z, std::int64_t back) {
    const std::size_t width = std::size_t(n_[0]);
    std::fill(best_.begin(), best_.end(), kFar);
    const std::uint8_t* const before[] = {row(y - back, z), row(y - 1, z - back), row(y, z - back),
                                          row(y + 1, z - back)};
    for (const std::uint8_t* r : before)
      if (r)
        for (std::size_t x = 0; x < width; ++x) best_[x] = std::min(best_[x], r[x]);
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint8_t left = x > 0 ? best_[x - 1] : kFar, right = x + 1 < width ? best_[x + 1] : kFar;
      spread_[x] = farther(std::min({left, best_[x], right}));
    }
    std::uint8_t* const d = row(y, z);
    for (std::size_t x = 0; x < width; ++x) d[x] = std::min(d[x], spread_[x]);
    for (std::size_t x = 1; x < width; ++x) d[x] = std::min(d[x], farther(d[x - 1]));
    for (std::size_t x = width - 1; x-- > 0;) d[x] = std::min(d[x], farther(d[x + 1]));
  }

  std::vector<std::uint8_t>& distance_;
  std::array<std::int64_t, 3> n_;
  std::vector<std::uint8_t> best_, spread_;
};

}  // namespace

void chebyshev_transform(std::vector<std::uint8_t>& distance, const Index3& size) {
  Sweep sweep(distance, size);
  sweep.run(1);
  sweep.run(-1);
}

}  // namespace mesocell
