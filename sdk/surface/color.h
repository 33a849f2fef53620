#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/recipe.h"

namespace mesocell MESOCELL_API {

/// The colors that a recipe gives a cell object: a solid texture of the tile, or a color for each cell.
struct Colors {
  std::optional<ColorMap> map;
  std::vector<Rgb8> cells;
};

/// Makes the colors of a recipe: `marble`, `wood` or `stone` (solid textures that tile without a seam;
/// options resolution and seed), or `cells` (a random color for each of `cell_count` cells; option seed).
/// Errors: kUsage. The same recipe gives the same colors on every machine.
[[nodiscard]] Result<Colors> make_colors(const Recipe& recipe, std::uint32_t cell_count);

/// The recipes and their options, a line each, for help texts.
[[nodiscard]] std::string color_recipes_help();

/// How well a color map continues across the tile's border: steps between neighbouring voxels there against
/// those within, of the values and of the differences between them. A ratio far above 1 is a visible seam.
struct WrapCheck {
  double value_ratio = 0;  ///< mean |step| across the border over mean |step| within, the worst of three axes
  double gradient_ratio = 0;  ///< the same of second differences
};
[[nodiscard]] WrapCheck check_wrap(const ColorMap& map);

}  // namespace MESOCELL_API
