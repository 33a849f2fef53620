#include "converters/cli/exit_codes.h"

#include <array>
#include <cstddef>

namespace mesocell {
namespace {

struct ErrorRow {
  ErrorCode code;
  ExitCode exit;
  const char* name;
};

constexpr std::array<ErrorRow, 6> kErrorRows = {{
    {ErrorCode::kUsage, kExitUsage, "usage"},
    {ErrorCode::kUnreadable, kExitInput, "unreadable"},
    {ErrorCode::kInvalidInput, kExitInput, "invalid-input"},
    {ErrorCode::kOutput, kExitOutput, "output"},
    {ErrorCode::kLimit, kExitLimit, "limit"},
    {ErrorCode::kCancelled, kExitInterrupted, "interrupted"},
}};

const ErrorRow& row(ErrorCode code) {
  for (const ErrorRow& candidate : kErrorRows)
    if (candidate.code == code) return candidate;
  return kErrorRows[0];
}

}  // namespace

ExitCode exit_code(ErrorCode code) { return row(code).exit; }

const char* error_name(ErrorCode code) { return row(code).name; }

const char* exit_codes_help() {
  return "Exit codes:\n"
         "  0    done\n"
         "  1    the check failed (validate, compare)\n"
         "  2    wrong usage\n"
         "  3    the input is missing, unreadable or invalid\n"
         "  4    the output could not be written\n"
         "  5    a limit was exceeded\n"
         "  130  interrupted\n";
}

}  // namespace mesocell
