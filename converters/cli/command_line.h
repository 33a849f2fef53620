#pragma once

namespace mesocell {

/// Parses the command line, runs the subcommand and returns the exit code. The only place that knows the
/// parser.
[[nodiscard]] int run_command_line(int argc, char** argv);

}  // namespace mesocell
