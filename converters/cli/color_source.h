#pragma once

#include <optional>
#include <string>
#include <vector>

#include "converters/cli/console.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/recipe.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/surface/color.h"

namespace mesocell {

/// Makes or reads the colors that --color names. `surface`: of the shape, whose own colors may be wanted;
/// remarks are added to `warnings`. Untrusted files: safe.
[[nodiscard]] std::optional<Failure> make_sourced_colors(const Recipe& recipe, std::uint32_t cell_count,
                                                         const TriangleMesh& surface,
                                                         const Progress& progress, Colors& colors,
                                                         std::vector<Warning>& warnings);

/// Recipes and imports with their options, for help texts.
[[nodiscard]] std::string color_sources_help();

}  // namespace mesocell
