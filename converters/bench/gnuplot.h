#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Runs gnuplot, found in PATH, with its own defaults alone, and gives what it writes to its standard output.
/// No shell is involved. `script` is trusted: texts of others in it must have passed gnuplot_text(). Errors:
/// kOutput (not there, or it failed), kLimit (over two minutes, or 64 MiB), kCancelled.
[[nodiscard]] Result<std::vector<std::byte>> run_gnuplot(const std::string& script, const Progress* progress);

/// A text as a quoted one of a script. What could be read as a command, and what is not plain ASCII, becomes
/// '?'; what is over 120 letters long is cut.
[[nodiscard]] std::string gnuplot_text(std::string_view text);

}  // namespace mesocell
