#pragma once

#include <optional>
#include <string>
#include <vector>

#include "converters/cli/commands.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/vec.h"
#include "sdk/shade/render.h"

namespace mesocell {

struct ClipPlane {
  Vec3 normal;
  double distance = 0;
};

/// What the words of `render` mean.
struct RenderPlan {
  RenderOptions options;
  std::optional<ClipPlane> clip;
  bool uses_environment = false;
  std::vector<Warning> warnings;  ///< options that have no effect
};

/// Checks every option by itself; reads no file. Fills `plan`.
[[nodiscard]] std::optional<Failure> make_render_plan(const RenderCommand& command, RenderPlan& plan);

}  // namespace mesocell
