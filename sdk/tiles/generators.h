#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/core/recipe.h"
#include "sdk/tiles/tile_builder.h"

namespace mesocell {

/// What every generator is given.
struct GeneratorOptions {
  Index3 resolution{64, 64, 64};  ///< voxels, 4…1024 each
  std::uint32_t cells = 8;        ///< 1…65535
  std::uint64_t seed = 1;
  Recipe recipe = {};  ///< for the generator's own options, whose names are checked
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

/// Voronoi cells of random seeds on the torus. A tie goes to the lower cell, then to the image of lesser
/// (z, y, x). [Nürnberg 2011, 4.1] Own option `metric`: `euclidean`; `anisotropic`, every seed with its own
/// ellipsoids of equal distance; `additive`, distance minus a weight (Apollonius diagram); `multiplicative`,
/// distance divided by a weight (Möbius diagram).
[[nodiscard]] Result<TileMap> make_voronoi_tile(const GeneratorOptions& options, TileReport* report);

/// Disjoint spheres in empty space: random centres, each sphere grown until it touches another (or to twice
/// the common starting radius). A voxel belongs to a sphere if its centre is inside. [Nürnberg 2011, 4.1]
[[nodiscard]] Result<TileMap> make_spheres_tile(const GeneratorOptions& options, TileReport* report);

/// Disjoint ellipsoids: one in each of the spheres of make_spheres_tile(), touching it at both ends of its
/// longest axis, turned at random. Own option `flatness`: the shortest axis is drawn from [1 - flatness, 1]
/// of the longest.
[[nodiscard]] Result<TileMap> make_ellipsoids_tile(const GeneratorOptions& options, TileReport* report);

/// Cells cut from Worley's basis [Worley 1996]: a voxel goes to the nearest seed where a sum of the distances
/// F1…F4 to the four nearest exceeds a threshold, and is empty elsewhere. Own options: `combine`, such as
/// f2-f1 or 2*f1-f3; `threshold`, in mean distances between seeds; `keep`, `above` or `below` the threshold.
[[nodiscard]] Result<TileMap> make_worley_tile(const GeneratorOptions& options, TileReport* report);

/// Bricks in running bond along x, courses stacked along y, each one brick deep along z, with mortar as empty
/// space. Own options: `mortar`, its thickness as a share of a course's height; `courses`, an even number (by
/// default what makes bricks about twice as long as high). `cells` must be a multiple of the courses.
[[nodiscard]] Result<TileMap> make_bricks_tile(const GeneratorOptions& options, TileReport* report);

}  // namespace mesocell
