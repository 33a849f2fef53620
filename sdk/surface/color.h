#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/recipe.h"
#include "sdk/surface/color_field.h"

namespace mesocell MESOCELL_API {

/// The colors of a cell object: a solid texture of the tile, a color for each cell, or colors that are
/// defined in space, for each INSIDE instance and for the surface, which are found once the object is there.
struct Colors {
  std::optional<ColorMap> map;
  std::optional<ColorList> cells;
  /// From the finished object: make_mesh_color_field(), say.
  std::function<Result<ColorField>(const CellObject&, unsigned threads, const Progress*)> field = {};
  /// Color voxels of a tile for colors of the surface, see make_surface_colors(); absent: instances alone.
  std::optional<Index3> surface_resolution = {};
};

/// Makes the colors of a recipe: `marble`, `wood` or `stone` (solid textures that tile without a seam;
/// options resolution and seed), or `cells` (a random color for each of `cell_count` cells; option seed).
/// Errors: kUsage. The same recipe gives the same colors on every machine.
[[nodiscard]] Result<Colors> make_colors(const Recipe& recipe, std::uint32_t cell_count);

/// Gives a finished cell object its colors, in place of any that it has. `threads`: 0 for the machine's.
/// Errors: those of colors.field, make_instance_colors() and
/// make_surface_colors(); the object is as it was then.
[[nodiscard]] Status apply_colors(Colors colors, CellObject& object, unsigned threads = 0,
                                  const Progress* progress = nullptr);

/// The recipes and their options, a line each, for help texts.
[[nodiscard]] std::string color_recipes_help();

/// How well a color map continues across the tile's border: the mean step there between neighbouring voxels
/// against that between any two neighbouring planes within, of the values and of the differences between
/// them. Against the greatest of those, not their mean: a texture may have hard edges in some planes, and one
/// of them at the border.
struct WrapCheck {
  static constexpr std::uint32_t kLeastVoxels =
      8;  ///< axes with fewer are not judged: planes differ too much
  /// Solids that tile stay below it from 8 voxels on; those that were cut exceed it, unless they change as
  /// much from voxel to voxel within (grains or rings of few voxels). The tests print the figures.
  static constexpr double kSeam = 1.4;

  double value_ratio = 0;     ///< mean |step| across the border over the greatest within, the worst axis
  double gradient_ratio = 0;  ///< the same of second differences

  /// Whether one of the borders is likely to be seen.
  [[nodiscard]] bool has_seam() const { return value_ratio > kSeam || gradient_ratio > kSeam; }
};
[[nodiscard]] WrapCheck check_wrap(const ColorMap& map);

}  // namespace mesocell
