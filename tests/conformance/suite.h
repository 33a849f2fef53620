#pragma once

#include <string>
#include <vector>

#include "tests/conformance/cases.h"
#include "tests/conformance/manifest.h"

/// Cases as files.
namespace mesocell::test {

inline constexpr std::size_t kMostFileBytes = 16 << 10;

/// Whether a case is one of the suite's files: small, and read with the limits that every reader has.
[[nodiscard]] bool is_file(const Case& c);
/// From the suite's folder.
[[nodiscard]] std::string path_of(const Case& c);
/// Ids of the validator's report, each once, in the order of the report.
[[nodiscard]] std::vector<std::string> report_of(std::span<const std::byte> file,
                                                 const ReadLimits& limits = {});
/// Of all cases that are files. Throws std::logic_error if a valid one is not.
[[nodiscard]] conformance::Manifest manifest_of(const std::vector<Case>& cases);

}  // namespace mesocell::test
