#pragma once

#include <vector>

#include "sdk/tiles/generators.h"

namespace mesocell {

/// Lengths in 1/1024 voxel.
struct Sphere {
  TilePoint centre{};
  double radius = 0;
};

/// One sphere a cell, disjoint on the torus and from their own images: random centres at which a quarter of
/// the tile is filled by equal spheres, then each grown in turn until it touches another or is twice as
/// large.
[[nodiscard]] std::vector<Sphere> pack_spheres(const GeneratorOptions& options);

}  // namespace mesocell
