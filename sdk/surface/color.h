#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/recipe.h"

namespace mesocell {

/// The colors that a recipe gives a cell object: a solid texture of the tile, or a color for each cell.
struct Colors {
  std::optional<ColorMap> map;
  std::vector<Rgb8> cells;
};

/// Makes the colors of a recipe: `marble`, `wood` or `stone` (solid textures that tile without a seam; options
/// resolution and seed), or `cells` (a random color for each of `cell_count` cells; option seed).
/// Errors: kUsage. The same recipe gives the same colors on every machine.
[[nodiscard]] Result<Colors> make_colors(const Recipe& recipe, std::uint32_t cell_count);

/// The recipes and their options, a line each, for help texts.
[[nodiscard]] std::string color_recipes_help();

/// How well a color map continues across the tile's border: the mean step there between neighbouring voxels
/// against that between any two neighbouring planes within, of the values and of the differences between them.
/// Against the greatest of those, not their mean: a texture may have hard edges in some planes, and one of them
/// at the border.
struct WrapCheck {
  static constexpr std::uint32_t kLeastVoxels = 8;  ///< axes with fewer are not judged: planes differ too much
  /// Solids that tile stay below it from 8 voxels on; those that were cut exceed it, unless they change as much
  /// from voxel to voxel within (grains or rings of few voxels). The tests print the figures.
  static constexpr double kSeam = 1.4;

  double value_ratio = 0;     ///< mean |step| across the border over the greatest within, the worst axis
  double gradient_ratio = 0;  ///< the same of second differences

  /// Whether one of the borders is likely to be seen.
  [[nodiscard]] bool has_seam() const { return value_ratio > kSeam || gradient_ratio > kSeam; }
};
[[nodiscard]] WrapCheck check_wrap(const ColorMap& map);

}  // namespace mesocell
