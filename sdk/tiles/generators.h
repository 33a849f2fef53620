#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/tiles/tile_builder.h"

namespace mesocell {

/// What every generator is given.
struct GeneratorOptions {
  Index3 resolution{64, 64, 64};  ///< voxels, 4…1024 each
  std::uint32_t cells = 8;        ///< 1…65535
  std::uint64_t seed = 1;
  unsigned threads = 0;
  const Progress* progress = nullptr;
};

/// A point of the tile in whole 1/1024 voxels, so that distances are integers: ties are exact, and the same
/// on every machine.
using TilePoint = std::array<std::int32_t, 3>;
inline constexpr std::int32_t kTileUnit = 1024;

/// `count` points, uniform in the tile. A seed gives the same points, as fractions of the tile, at every
/// resolution (to 1/1024 voxel).
[[nodiscard]] std::vector<TilePoint> random_tile_points(const GeneratorOptions& options, std::uint32_t count);

/// Voronoi cells of random seeds on the torus, Euclidean distance between voxel centre and seed image. A tie
/// goes to the lower cell, then to the image of lesser (z, y, x). [Nürnberg 2011, 4.1]
[[nodiscard]] Result<TileMap> make_voronoi_tile(const GeneratorOptions& options, TileReport* report);

/// Disjoint spheres in empty space: random centres, each sphere grown until it touches another (or to twice
/// the common starting radius). A voxel belongs to a sphere if its centre is inside. [Nürnberg 2011, 4.1]
[[nodiscard]] Result<TileMap> make_spheres_tile(const GeneratorOptions& options, TileReport* report);

}  // namespace mesocell
