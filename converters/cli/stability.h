#pragma once

#include <string>

namespace mesocell {

/// For the help text of --methods.
[[nodiscard]] std::string stability_methods_help();
/// What stands below the options: methods, kinds of damage, keys of --json, examples.
[[nodiscard]] std::string stability_help();

}  // namespace mesocell
