#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/rng.h"

/// Cell objects for tests of the format: valid by construction, with nothing to do with any mesh.
namespace mesocell::test {

/// Which maps of color and normals an object has.
enum TestMaps : unsigned {
  kColorMap = 1,
  kCellColors = 2,
  kInstanceColors = 4,
  kNormals = 8,
  kMapsOf1_0 = 15,
  kSurfaceColors = 16,  ///< which makes files of 1.1
  kAllMaps = 31
};

struct RandomObjectOptions {
  Index3 resolution{4, 5, 6};
  Index3 tiles{3, 2, 4};
  std::uint32_t cells = 5;        ///< tried; cells that get no voxel are left out
  int reach = 1;                  ///< homes before they are normalised, −reach…reach tiles
  std::uint32_t block = 1;        ///< voxels of this many along each axis share a label, which compresses
  std::uint32_t longest_run = 6;  ///< tiles in a row with one kind of membership
  std::uint32_t texts = 2;
  unsigned maps = 0;  ///< sum of TestMaps
};

/// A tile of random labels: every voxel gets a cell and an image of it, then homes are moved to obey the home
/// rule.
[[nodiscard]] TileMap random_tile(Rng& rng, const RandomObjectOptions& options);
/// Bricks in about every second tile, colors in about every second color voxel of some and in all or one of
/// others; at least one. `tile`: the resolution of the tile.
[[nodiscard]] SurfaceColors random_surface_colors(Rng& rng, const Index3& tile, std::uint64_t tiles);
[[nodiscard]] CellObject random_object(std::uint64_t seed, const RandomObjectOptions& options = {});
/// Options drawn from the seed: small objects of all kinds, a third of them with surface colors.
[[nodiscard]] CellObject random_small_object(std::uint64_t seed);

/// The object of spec section 7.
[[nodiscard]] CellObject walkthrough_object();

/// Four small files, raw and compressed, with and without text; the last one with all maps.
[[nodiscard]] std::vector<std::vector<std::byte>> small_files();

/// encode_cell_object() of an object that must encode.
[[nodiscard]] std::vector<std::byte> encoded(const CellObject& object);

}  // namespace mesocell::test
