#pragma once

#include <optional>
#include <vector>

#include "converters/cli/commands.h"
#include "converters/cli/tile_source.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/recipe.h"

namespace mesocell {

/// What the words of `convert` mean.
struct ConvertPlan {
  TileSource tile;
  TileSourceOptions tile_options;
  std::optional<Recipe> color;
  AuthorOptions author;
  std::vector<Warning> warnings;  ///< options that do nothing
};

/// Checks all that can be checked before work is done.
[[nodiscard]] std::optional<Failure> make_convert_plan(const ConvertCommand& command, ConvertPlan& plan);

/// Defaults of `convert`, for help texts.
inline constexpr std::int64_t kDefaultTiles = 16;
inline constexpr const char* kDefaultTile = "voronoi:cells=8,resolution=64,seed=1";

}  // namespace mesocell
