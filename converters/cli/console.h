#pragma once

#include <string>
#include <string_view>

#include "converters/cli/exit_codes.h"
#include "format/result.h"

namespace mesocell {

/// Options that every subcommand has.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  unsigned threads = 0;  ///< 0: the machine's
};

/// Where messages and results go: results to stdout, all else to stderr.
class Console {
 public:
  explicit Console(const CommonOptions& options) : json_(options.json), quiet_(options.quiet) {}

  /// Prints "mesocell: SUBJECT: MESSAGE" and, with --json, an object {"error": …} on stdout. Returns the exit
  /// code. `subject` is a file or an option; empty where neither is at fault.
  int fail(const Error& error, const std::string& subject) const;

  /// A remark on stderr, unless --quiet.
  void warn(const std::string& subject, std::string_view text) const;

  /// Prints a result and returns `code`. A closed pipe is no failure; any other one is kExitOutput.
  int finish(std::string_view text, int code = kExitDone) const;

  [[nodiscard]] bool json() const { return json_; }
  [[nodiscard]] bool quiet() const { return quiet_; }

 private:
  int report(ErrorCode kind, std::string_view message, std::string_view id, const std::string& subject) const;

  bool json_, quiet_;
};

/// Text for a terminal: control characters of a hostile name or file are shown, not obeyed.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace mesocell
