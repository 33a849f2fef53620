#pragma once

#include <optional>
#include <string>
#include <vector>

#include "converters/cli/console.h"
#include "converters/import/read_notes.h"
#include "format/cell_object.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/recipe.h"
#include "sdk/surface/color.h"
#include "sdk/tiles/labels.h"

namespace mesocell {

/// What --tile names.
struct TileSource {
  Recipe recipe;       ///< of a generator or of an import; unused if `saved` is set
  std::string saved;   ///< a .meso file whose tile is taken over
  std::string option;  ///< for messages: "--tile", or the input
};

/// Parses a recipe or the name of a .meso file. Errors: kUsage.
[[nodiscard]] Result<TileSource> parse_tile_source(const std::string& text, std::string option);

/// Whether it is imported from labels, of which cells may have to be cut.
[[nodiscard]] bool reads_labels(const TileSource& source);

/// A tile and what came with it.
struct SourcedTile {
  TileMap tile;
  std::string recipe;  ///< for the metadata: how it was made, files by their names without folders
  Colors colors;
  std::string color_recipe;  ///< of these colors, for the metadata; may be empty
  std::optional<NormalMap> normals;
  std::vector<Warning> warnings;
  ReadNotes notes;
};

struct TileSourceOptions {
  Percolating percolating = Percolating::kCut;
  unsigned threads = 0;
};

/// Makes, imports or takes over the tile. Untrusted files: safe.
[[nodiscard]] std::optional<Failure> make_sourced_tile(const TileSource& source,
                                                       const TileSourceOptions& options,
                                                       const Progress& progress, SourcedTile& tile);

/// A recipe with files by their names alone: where they lie is of no interest to whoever gets the asset.
[[nodiscard]] Recipe without_folders(Recipe recipe);

/// Generators and imports with their options, for help texts.
[[nodiscard]] std::string tile_sources_help();

}  // namespace mesocell
