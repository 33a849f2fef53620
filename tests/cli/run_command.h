#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mesocell::test {

/// What a run of the command gave.
struct Run {
  int exit = -1;  ///< minus the signal's number if one ended it
  std::string out, err;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }
  /// Lines on stderr.
  [[nodiscard]] std::size_t messages() const;
};

struct RunOptions {
  /// A signal that is sent after this time, if the command still runs.
  std::optional<std::chrono::milliseconds> signal_after;
  int signal = 0;
  std::string signal_when;               ///< or as soon as this stands on the terminal
  bool terminal = false;                 ///< stderr is a terminal
  std::string stdout_path;               ///< stdout goes there instead
  bool closed_stdout = false;            ///< stdout is a pipe that nobody reads
  std::vector<std::string> environment;  ///< "NAME=value", added
};

/// Runs the command with these arguments and waits for its end; after two minutes it is killed.
[[nodiscard]] Run run_command(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// Runs any program.
[[nodiscard]] Run run_program(const std::string& program, const std::vector<std::string>& arguments,
                              const RunOptions& options = {});

}  // namespace mesocell::test
