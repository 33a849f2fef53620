#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/api.h"
#include "format/issues.h"
#include "format/limits.h"

namespace mesocell MESOCELL_API {

/// What validate() found.
struct ValidationReport {
  bool valid = false;          ///< no issue is an error
  std::uint64_t errors = 0;    ///< that were found, also what is not listed; many of one kind may count as 16
  std::uint64_t warnings = 0;  ///< the same
  std::vector<Issue> issues;   ///< in the order in which they were found
  bool capped = false;         ///< there are more issues than are listed
};

/// Checks a file section by section and goes on after a fault wherever what follows can still be made out.
/// Lists at most `max_issues` (at least 1), and of each kind at most 16. Untrusted input: safe.
/// A file over a limit gets the issue limit-exceeded.
[[nodiscard]] ValidationReport validate(std::span<const std::byte> file, const ReadLimits& limits = {},
                                        std::size_t max_issues = 256);

}  // namespace mesocell
