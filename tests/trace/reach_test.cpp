#include "sdk/trace/reach.h"

#include <algorithm>
#include <cstdlib>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"

using namespace mesocell;

TEST_CASE("Chebyshev distances equal brute force") {
  Rng rng(1);
  for (const Index3 n : {Index3{9, 7, 5}, Index3{16, 16, 16}, Index3{1, 20, 3}}) {
    std::vector<std::uint8_t> d(std::size_t{n[0]} * n[1] * n[2], 255);
    std::vector<std::array<int, 3>> zeros;
    for (std::size_t i = 0; i < d.size(); ++i)
      if (i == 7 || rng.below(60) == 0) {
        d[i] = 0;
        zeros.push_back({int(i % n[0]), int(i / n[0] % n[1]), int(i / n[0] / n[1])});
      }
    REQUIRE_FALSE(zeros.empty());
    chebyshev_transform(d, n);
    for (std::size_t i = 0; i < d.size(); ++i) {
      const int p[3] = {int(i % n[0]), int(i / n[0] % n[1]), int(i / n[0] / n[1])};
      int least = 255;
      for (const auto& z : zeros) {
        int distance = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          distance = std::max(distance, std::abs(p[a] - z[a]));
        }
        least = std::min(least, distance);
      }
      REQUIRE(int(d[i]) == least);
    }
  }
}
