#pragma once

#include <string>

#include "converters/cli/commands.h"

namespace mesocell {

/// Whether `convert` takes an asset to another format.
[[nodiscard]] bool is_export(const ConvertCommand& command);

/// `convert` of an asset to another format. Returns the exit code.
[[nodiscard]] int run_export(const ConvertCommand& command);

/// The kinds with their extensions, for help texts.
[[nodiscard]] std::string exports_help();

}  // namespace mesocell
