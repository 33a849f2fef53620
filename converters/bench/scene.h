#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// A tile that scenes are made of: 8 cells or so, by a fixed seed.
struct BenchTile {
  std::string_view name;
  std::string_view recipe;  ///< without the resolution
};
[[nodiscard]] std::span<const BenchTile> bench_tiles();

/// "wavy-voronoi-64x32": a shape in a cube of 64³ tiles of 32³ voxels, about the origin, with an edge of 1.
struct SceneName {
  std::string shape, tile;
  std::uint32_t tiles = 0;       ///< along an edge of the grid, 4…256
  std::uint32_t resolution = 0;  ///< voxels along an edge of the tile, 4…256

  [[nodiscard]] std::string text() const;
};

/// Errors: kUsage, with the names there are.
[[nodiscard]] Result<SceneName> parse_scene_name(std::string_view text);

/// Makes the scene; the same on every run and for every number of threads. Errors: kCancelled, kLimit.
[[nodiscard]] Result<CellObject> make_scene(const SceneName& name, unsigned threads,
                                            const Progress& progress);

}  // namespace mesocell
