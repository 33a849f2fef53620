#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "converters/cli/commands.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// What a comparison gave: the result for --json, with all its keys, and its text.
struct Comparison {
  nlohmann::ordered_json json;
  std::string text;
};

/// Compares command.a, an asset, with command.b, a mesh.
[[nodiscard]] std::optional<Failure> compare_with_mesh(const CompareCommand& command,
                                                       const Progress& progress, Comparison& result);

}  // namespace mesocell
