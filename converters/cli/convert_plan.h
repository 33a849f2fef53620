#pragma once

#include <optional>
#include <vector>

#include "converters/cli/commands.h"
#include "converters/cli/tile_source.h"
#include "format/container.h"
#include "format/text_chunk.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/recipe.h"

namespace mesocell {

/// What the words of `convert` mean.
struct ConvertPlan {
  TileSource tile;
  TileSourceOptions tile_options;
  std::optional<Recipe> color;
  AuthorOptions author;
  WriteOptions write;
  Metadata metadata;              ///< of --meta
  std::vector<Warning> warnings;  ///< options that do nothing
};

/// What --codec, --target-version and --meta mean.
[[nodiscard]] std::optional<Failure> parse_write_options(const ConvertCommand& command, WriteOptions& options,
                                                         Metadata& metadata);

/// Whether inputs and output can be those of a conversion, and the output can be written. `more_input`: a
/// file that is read too, or empty.
[[nodiscard]] std::optional<Failure> check_convert_files(const ConvertCommand& command,
                                                         const std::string& more_input);

/// Checks all that can be checked before work is done.
[[nodiscard]] std::optional<Failure> make_convert_plan(const ConvertCommand& command, ConvertPlan& plan);

/// Defaults of `convert`, for help texts.
inline constexpr std::int64_t kDefaultTiles = 16;
inline constexpr const char* kDefaultTile = "voronoi:cells=8,resolution=64,seed=1";

}  // namespace mesocell
