#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/conformance/cases.h"
#include "tests/conformance/manifest.h"

/// Cases as files.
namespace mesocell::test {

inline constexpr std::size_t kMostFileBytes = 16 << 10;

/// Whether a case is one of the suite's files: small, and read with the limits that every reader has.
[[nodiscard]] bool is_file(const Case& c);
/// The versions of the format that have a suite: a folder of this name each, which has what the version
/// brought.
inline constexpr std::string_view kSuites[] = {"1.0", "1.1"};
/// From the folder of its suite.
[[nodiscard]] std::string path_of(const Case& c);
/// Ids of the validator's report, each once, in the order of the report.
[[nodiscard]] std::vector<std::string> report_of(std::span<const std::byte> file,
                                                 const ReadLimits& limits = {});
/// Of all cases of a version that are files. Throws std::logic_error if a valid one is not.
[[nodiscard]] conformance::Manifest manifest_of(const std::vector<Case>& cases, std::string_view version);

}  // namespace mesocell::test
