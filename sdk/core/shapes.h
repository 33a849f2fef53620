#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/recipe.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// A shape to try things with: a closed mesh, outward, without self-intersections, in [-0.5, 0.5]³, the same
/// on every machine.
struct Shape {
  std::string_view name, description;
  /// `detail`, from 1: how finely round parts are cut, times as fine along each direction.
  TriangleMesh (*make)(std::uint32_t detail);
};

/// All of them, and that of a name, null if there is none.
[[nodiscard]] std::span<const Shape> shapes();
[[nodiscard]] const Shape* find_shape(std::string_view name);

/// Makes the mesh of a recipe such as "torus" or "sphere:size=0.5,detail=2", its box centred on the origin;
/// size: the longest side of the box, metres [1]; detail: as in Shape, to 16 [1]. Errors: kUsage (unknown
/// shape or option, value out of range).
[[nodiscard]] Result<TriangleMesh> make_shape(const Recipe& recipe);

/// The shapes, a line each, for help texts.
[[nodiscard]] std::string shapes_help();

}  // namespace mesocell
