#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// A tile's recipe, as written on the command line: "voronoi:cells=8,resolution=128,seed=1".
struct TileSpec {
  std::string generator;
  std::map<std::string, std::string> options;
};

/// Splits the text of a recipe. Errors: kUsage with what is wrong in it. Trust: any text.
[[nodiscard]] Result<TileSpec> parse_tile_spec(std::string_view text);

/// What making a tile had to report.
struct TileReport {
  std::uint32_t dropped_cells = 0;  ///< cells that got no voxel, left out; the rest were renumbered
};

/// Makes the tile of a recipe. Errors: kUsage (unknown generator or option, value out of range), kCancelled.
/// The same recipe gives the same tile on every machine and for every number of threads.
[[nodiscard]] Result<TileMap> make_tile(const TileSpec& spec, unsigned threads = 0,
                                        TileReport* report = nullptr, const Progress* progress = nullptr);

/// The generators and their options, a line each, for help texts.
[[nodiscard]] std::string tile_generators_help();

}  // namespace mesocell
