#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/recipe.h"

namespace mesocell {

/// What making a tile had to report.
struct TileReport {
  std::uint32_t dropped_cells = 0;      ///< cells that got no voxel, left out; the rest were renumbered
  std::uint32_t percolating_cells = 0;  ///< imported cells that met their own copy and were cut
  std::uint64_t contested_voxels = 0;   ///< imported voxels that more than one cell claimed
};

/// Makes the tile of a recipe, such as "voronoi:cells=8,resolution=128,seed=1". Errors: kUsage (unknown
/// generator or option, value out of range), kCancelled. The same recipe gives the same tile on every machine
/// and for every number of threads.
[[nodiscard]] Result<TileMap> make_tile(const Recipe& recipe, unsigned threads = 0,
                                        TileReport* report = nullptr, const Progress* progress = nullptr);

/// All names of generators, with commas between them, and whether a name is one.
[[nodiscard]] std::string tile_generator_names();
[[nodiscard]] bool is_tile_generator(std::string_view name);

/// The generators and their options, a line each, for help texts.
[[nodiscard]] std::string tile_generators_help();

}  // namespace mesocell
