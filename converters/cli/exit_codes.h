#pragma once

#include "format/result.h"

namespace mesocell {

/// What the command returns to its caller. The same table stands in --help.
enum ExitCode : int {
  kExitDone = 0,
  kExitCheckFailed = 1,
  kExitUsage = 2,
  kExitInput = 3,
  kExitOutput = 4,
  kExitLimit = 5,
  kExitInterrupted = 130,
};

[[nodiscard]] ExitCode exit_code(ErrorCode code);

/// The error's kind as scripts see it, e.g. "unreadable".
[[nodiscard]] const char* error_name(ErrorCode code);

/// The table of exit codes, a line each, for help texts.
[[nodiscard]] const char* exit_codes_help();

}  // namespace mesocell
