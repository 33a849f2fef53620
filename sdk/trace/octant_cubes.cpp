#include "sdk/trace/octant_cubes.h"

#include <algorithm>

namespace mesocell {
namespace {

/// For each entry whether the cube of two entries upward from it is set, beyond the block being so.
Bits64 eroded(Bits64 m) {
  m &= m >> 1 | 0x8888888888888888;
  m &= m >> 4 | 0xf000f000f000f000;
  return m & (m >> 16 | 0xffff000000000000);
}

}  // namespace

Bits64 mirrored(Bits64 m, unsigned octant) {
  if (!(octant & 1)) {
    m = (m & 0x3333333333333333) << 2 | (m >> 2 & 0x3333333333333333);
    m = (m & 0x5555555555555555) << 1 | (m >> 1 & 0x5555555555555555);
  }
  if (!(octant & 2)) {
    m = (m & 0x00ff00ff00ff00ff) << 8 | (m >> 8 & 0x00ff00ff00ff00ff);
    m = (m & 0x0f0f0f0f0f0f0f0f) << 4 | (m >> 4 & 0x0f0f0f0f0f0f0f0f);
  }
  if (!(octant & 4)) {
    m = m << 32 | m >> 32;
    m = (m & 0x0000ffff0000ffff) << 16 | (m >> 16 & 0x0000ffff0000ffff);
  }
  return m;
}

std::array<std::uint8_t, 64> upward_cubes(Bits64 free) {
  std::array<std::uint8_t, 64> edge{};
  for (int e = 0; e < 4 && free != 0; ++e, free = eroded(free))
    for (unsigned k = 0; k < 64; ++k) edge[k] = std::uint8_t(edge[k] + (free >> k & 1));
  return edge;
}

std::vector<std::uint8_t> octant_cubes(const std::vector<std::uint8_t>& free, const Index3& size,
                                       unsigned octant) {
  const std::int64_t nx = size[0], ny = size[1], nz = size[2];
  std::vector<std::uint8_t> edge(free.size());
  std::vector<std::uint8_t> beyond(std::size_t(nx), 255);
  const std::int64_t up_y = octant & 2 ? 1 : -1, up_z = octant & 4 ? 1 : -1;
  std::vector<std::uint8_t> least(std::size_t(nx) + 2,
                                  255);  // of the three rows before, one entry of room each side
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j) {
      const std::int64_t z = octant & 4 ? nz - 1 - k : k, y = octant & 2 ? ny - 1 - j : j;
      const auto row = [&](std::int64_t at_y, std::int64_t at_z) {
        return at_y < 0 || at_z < 0 || at_y >= ny || at_z >= nz ? beyond.data()
                                                                : edge.data() + nx * (at_y + ny * at_z);
      };
      const std::uint8_t *a = row(y + up_y, z), *b = row(y, z + up_z), *c = row(y + up_y, z + up_z);
      for (std::int64_t x = 0; x < nx; ++x) least[std::size_t(x + 1)] = std::min({a[x], b[x], c[x]});
      std::uint8_t* const out = edge.data() + nx * (y + ny * z);
      const std::uint8_t* const in = free.data() + nx * (y + ny * z);
      std::uint8_t before = 255;
      for (std::int64_t i = 0; i < nx; ++i) {
        const std::int64_t x = octant & 1 ? nx - 1 - i : i;
        const std::uint8_t m =
            std::min({before, least[std::size_t(x + 1)], least[std::size_t(octant & 1 ? x + 2 : x)]});
        before = in[x] ? std::uint8_t(std::min(m, std::uint8_t{254}) + 1) : std::uint8_t{0};
        out[x] = before;
      }
    }
  return edge;
}

}  // namespace mesocell
