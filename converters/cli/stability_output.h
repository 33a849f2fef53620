#pragma once

#include <optional>
#include <string>
#include <vector>

#include "converters/cli/commands.h"
#include "converters/cli/console.h"

/// What the kinds of `mesocell stability` have in common.
namespace mesocell {

/// Whether the files that are asked for could be written.
[[nodiscard]] std::optional<Failure> check_stability_outputs(const StabilityCommand& command);

/// Writes the files that are asked for.
[[nodiscard]] std::optional<Failure> write_stability(const StabilityCommand& command, const std::string& csv,
                                                     const std::string& markdown, const std::string& picture);

/// `mesocell stability --cast`: options are checked, methods and cases found, all is measured and told.
[[nodiscard]] int run_cast_stability(const StabilityCommand& command, const Console& console);

/// Names, for messages; a line each with what they do, for help.
[[nodiscard]] std::string cast_method_names();
[[nodiscard]] std::string cast_methods_help();

}  // namespace mesocell
