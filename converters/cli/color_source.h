#pragma once

#include <optional>
#include <string>
#include <vector>

#include "converters/cli/console.h"
#include "converters/cli/shape_source.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/recipe.h"
#include "sdk/surface/color.h"

namespace mesocell {

/// Makes or reads the colors that --color names. `shape`: its own colors may be wanted, and it must then
/// outlive `colors`; remarks are added to `warnings` and `notes`. Untrusted files: safe.
[[nodiscard]] std::optional<Failure> make_sourced_colors(const Recipe& recipe, std::uint32_t cell_count,
                                                         const ShapeSource& shape, const Progress& progress,
                                                         Colors& colors, std::vector<Warning>& warnings,
                                                         ReadNotes& notes);

/// Whether --color asks for the mesh's own colors, which are then read with it.
[[nodiscard]] bool takes_mesh_colors(const std::optional<std::string>& color);

/// The picture that --color mesh:texture=FILE names, which is read with the mesh; empty if there is none.
[[nodiscard]] std::string texture_of_color(const std::optional<std::string>& color);

/// Recipes and imports with their options, for help texts.
[[nodiscard]] std::string color_sources_help();

}  // namespace mesocell
