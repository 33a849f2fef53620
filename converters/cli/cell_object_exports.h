#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "converters/cli/commands.h"
#include "format/cell_object.h"
#include "sdk/core/progress.h"

/// What cell objects are converted to.
namespace mesocell {

/// What an export is given.
struct ExportJob {
  const ConvertCommand& command;
  const CellObject& object;
  const Progress& progress;
  nlohmann::ordered_json& report;    ///< keys of its own are added
  std::vector<std::string>& losses;  ///< what is not kept, a line each
};

/// A kind of export. Of several that have an extension the first is taken unless --as names another.
struct ExportKind {
  std::string_view name;        ///< for --as
  std::string_view extensions;  ///< " .obj .ply "; "/" is a folder
  std::string_view help;
  std::string_view options;  ///< " --normals --region ": those that have an effect
  Status (*run)(const ExportJob& job);
};

[[nodiscard]] std::span<const ExportKind> cell_object_exports();

}  // namespace mesocell
