#include "sdk/trace/reach.h"

#include <algorithm>
#include <cstdlib>

#include "sdk/core/rng.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"

using namespace mesocell;

TEST_CASE("Chebyshev distances equal brute force, open and wrapped") {
  Rng rng(1);
  for (const Index3 n : {Index3{9, 7, 5}, Index3{16, 16, 16}, Index3{1, 20, 3}})
    for (const Border border : {Border::kOpen, Border::kWrapped}) {
      std::vector<std::uint8_t> d(std::size_t{n[0]} * n[1] * n[2], 255);
      std::vector<std::array<int, 3>> zeros;
      for (std::size_t i = 0; i < d.size(); ++i)
        if (i == 7 || rng.below(60) == 0) {
          d[i] = 0;
          zeros.push_back({int(i % n[0]), int(i / n[0] % n[1]), int(i / n[0] / n[1])});
        }
      REQUIRE_FALSE(zeros.empty());
      chebyshev_transform(d, n, border);
      for (std::size_t i = 0; i < d.size(); ++i) {
        const int p[3] = {int(i % n[0]), int(i / n[0] % n[1]), int(i / n[0] / n[1])};
        int least = 255;
        for (const auto& z : zeros) {
          int distance = 0;
          for (std::size_t a = 0; a < 3; ++a) {
            const int step = std::abs(p[a] - z[a]);
            distance =
                std::max(distance, border == Border::kWrapped ? std::min(step, int(n[a]) - step) : step);
          }
          least = std::min(least, distance);
        }
        REQUIRE(int(d[i]) == least);
      }
    }
}

TEST_CASE("all voxels within reach are of the same instance, and one beyond is not") {
  for (const char* recipe : {"voronoi:cells=3,resolution=12", "spheres:cells=2,resolution=13x9x11",
                             "voronoi:cells=1,resolution=10", "voronoi:cells=9,resolution=5"}) {
    const TileMap tile = *make_tile(*parse_recipe(recipe));
    const std::vector<std::uint8_t> reach = instance_reach(tile);
    const std::array<int, 3> n{int(tile.resolution[0]), int(tile.resolution[1]), int(tile.resolution[2])};
    // A voxel anywhere in space: its cell and its instance's home tile.
    const auto instance = [&](int x, int y, int z) {
      const int p[3] = {x, y, z};
      std::array<int, 4> key{};
      std::uint32_t at[3];
      int t[3];
      for (std::size_t a = 0; a < 3; ++a) {
        t[a] = p[a] >= 0 ? p[a] / n[a] : -((-p[a] + n[a] - 1) / n[a]);
        at[a] = std::uint32_t(p[a] - t[a] * n[a]);
      }
      const std::uint32_t id = tile.id(tile.voxel_index(at[0], at[1], at[2]));
      if (id == 0) return key;
      const Piece& piece = tile.pieces[id - 1];
      key[0] = piece.cell;
      for (std::size_t a = 0; a < 3; ++a) key[a + 1] = t[a] + piece.home[a];
      return key;
    };
    for (int z = 0; z < n[2]; ++z)
      for (int y = 0; y < n[1]; ++y)
        for (int x = 0; x < n[0]; ++x) {
          const int r = reach[tile.voxel_index(std::uint32_t(x), std::uint32_t(y), std::uint32_t(z))];
          bool same = true, beyond_same = true;
          for (int dz = -r - 1; dz <= r + 1; ++dz)
            for (int dy = -r - 1; dy <= r + 1; ++dy)
              for (int dx = -r - 1; dx <= r + 1; ++dx) {
                const bool equal = instance(x + dx, y + dy, z + dz) == instance(x, y, z);
                if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) <= r)
                  same = same && equal;
                else
                  beyond_same = beyond_same && equal;
              }
          REQUIRE(same);
          REQUIRE_FALSE(beyond_same);
        }
  }
}
