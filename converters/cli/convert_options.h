#pragma once

#include <CLI/App.hpp>

#include "converters/cli/commands.h"

namespace mesocell {

/// The subcommand `convert` and its options.
void add_convert(CLI::App& app, ConvertCommand& command);

/// Once the words are parsed: inputs and output, and the options that each file of a batch is converted with.
/// False if there is no output.
[[nodiscard]] bool complete_convert(const CLI::App& app, ConvertCommand& command);

}  // namespace mesocell
