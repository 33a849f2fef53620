#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "converters/cli/exit_codes.h"
#include "format/result.h"

namespace mesocell {

/// Options that every subcommand has.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  unsigned threads = 0;  ///< 0: the machine's
};

/// What kept a subcommand from its result, and the file or option that it is of; empty where neither is at
/// fault.
struct Failure {
  Error error;
  std::string subject;
};

/// A failure by wrong words on the command line.
[[nodiscard]] inline Failure usage(std::string subject, std::string message) {
  return {Error{ErrorCode::kUsage, std::move(message)}, std::move(subject)};
}

/// Where messages and results go: results to stdout, all else to stderr.
class Console {
 public:
  explicit Console(const CommonOptions& options) : json_(options.json), quiet_(options.quiet) {}

  /// Prints "mesocell: SUBJECT: MESSAGE" and, with --json, an object {"error": …} on stdout. Returns the exit
  /// code. `subject` is as of a Failure.
  int fail(const Error& error, const std::string& subject) const;
  int fail(const Failure& failure) const { return fail(failure.error, failure.subject); }
  /// With more in the object, beside "error".
  int fail_with(const Failure& failure, const nlohmann::ordered_json& more) const;

  /// A remark on stderr, unless --quiet.
  void warn(const std::string& subject, std::string_view text) const;

  /// Prints a result and returns `code`. A closed pipe is no failure; any other one is kExitOutput.
  int finish(std::string_view text, int code = kExitDone) const;

  [[nodiscard]] bool json() const { return json_; }
  [[nodiscard]] bool quiet() const { return quiet_; }

 private:
  int report(ErrorCode kind, std::string_view message, std::string_view id, const std::string& subject,
             const nlohmann::ordered_json& more) const;

  bool json_, quiet_;
};

/// Text for a terminal: control characters of a hostile name or file are shown, not obeyed.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace mesocell
