#include "sdk/trace/octant_cubes.h"

#include <algorithm>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

/// The edge of the largest cube from an entry in an octant's directions that is free, at most 255; beyond the
/// grid all is.
int edge_by_definition(const std::vector<std::uint8_t>& free, const Index3& size, unsigned octant,
                       const std::array<std::int64_t, 3>& from) {
  for (int edge = 0; edge < 255; ++edge)
    for (std::int64_t z = 0; z <= edge; ++z)
      for (std::int64_t y = 0; y <= edge; ++y)
        for (std::int64_t x = 0; x <= edge; ++x) {
          if (std::max({x, y, z}) < edge) continue;
          const std::int64_t at[3] = {from[0] + (octant & 1 ? x : -x), from[1] + (octant & 2 ? y : -y),
                                      from[2] + (octant & 4 ? z : -z)};
          bool beyond = false;
          for (std::size_t a = 0; a < 3; ++a) beyond = beyond || at[a] < 0 || at[a] >= size[a];
          if (!beyond && !free[std::size_t(at[0] + size[0] * (at[1] + size[1] * at[2]))]) return edge;
          // All that is left of the grid is nearer.
          if (std::int64_t{edge} > std::max({size[0], size[1], size[2]})) return 255;
        }
  return 255;
}

Bits64 random_block(Rng& rng) {
  Bits64 m = rng.next();
  for (std::uint32_t k = rng.below(6); k > 0; --k) m |= rng.next();
  return m;
}

}  // namespace

TEST_CASE("a block seen from the other side") {
  Rng rng(1);
  for (int k = 0; k < 1000; ++k) {
    const Bits64 block = random_block(rng);
    for (unsigned octant = 0; octant < 8; ++octant) {
      const Bits64 m = mirrored(block, octant);
      for (unsigned z = 0; z < 4; ++z)
        for (unsigned y = 0; y < 4; ++y)
          for (unsigned x = 0; x < 4; ++x) {
            const unsigned from =
                (octant & 1 ? x : 3 - x) + 4 * (octant & 2 ? y : 3 - y) + 16 * (octant & 4 ? z : 3 - z);
            REQUIRE((m >> (x + 4 * y + 16 * z) & 1) == (block >> from & 1));
          }
    }
  }
}

TEST_CASE("upward cubes of a block equal brute force") {
  Rng rng(2);
  std::array<std::size_t, 5> met{};
  for (int k = 0; k < 3000; ++k) {
    const Bits64 block = k == 0 ? ~Bits64{0} : k == 1 ? 0 : random_block(rng);
    std::vector<std::uint8_t> free(64);
    for (std::size_t i = 0; i < 64; ++i) free[i] = block >> i & 1;
    const std::array<std::uint8_t, 64> edges = upward_cubes(block);
    for (unsigned i = 0; i < 64; ++i) {
      REQUIRE(int(edges[i]) ==
              std::min(edge_by_definition(free, {4, 4, 4}, 7, {i & 3, i >> 2 & 3, i >> 4}), 4));
      ++met[edges[i]];
    }
  }
  for (const std::size_t count : met) CHECK(count > 100);
}

TEST_CASE("cubes of all octants equal brute force") {
  Rng rng(3);
  for (const Index3& n :
       {Index3{9, 7, 5}, Index3{16, 16, 16}, Index3{1, 20, 3}, Index3{1, 1, 1}, Index3{5, 1, 1}})
    for (const std::uint32_t rare : {2u, 40u, 4000u}) {
      std::vector<std::uint8_t> free(std::size_t{n[0]} * n[1] * n[2]);
      for (std::uint8_t& f : free) f = rng.below(rare) ? std::uint8_t(1 + rng.below(255)) : std::uint8_t{0};
      for (unsigned octant = 0; octant < 8; ++octant) {
        const std::vector<std::uint8_t> edges = octant_cubes(free, n, octant);
        REQUIRE(edges.size() == free.size());
        for (std::size_t i = 0; i < edges.size(); ++i) {
          const auto at = std::int64_t(i);
          INFO(n[0] << " x " << n[1] << " x " << n[2] << ", octant " << octant << ", entry " << i);
          REQUIRE(int(edges[i]) ==
                  edge_by_definition(free, n, octant, {at % n[0], at / n[0] % n[1], at / n[0] / n[1]}));
        }
      }
    }
}

TEST_CASE("cubes of long grids end at 255") {
  for (const unsigned octant : {0u, 7u}) {
    std::vector<std::uint8_t> free(600, 1);
    const std::size_t last = octant == 7 ? 599 : 0;
    free[last] = 0;
    const std::vector<std::uint8_t> edges = octant_cubes(free, {600, 1, 1}, octant);
    for (std::size_t k = 0; k < 600; ++k)
      REQUIRE(edges[octant == 7 ? 599 - k : k] == std::min<std::size_t>(k, 255));
  }
}
