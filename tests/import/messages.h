#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "converters/import/mesh_file.h"
#include "tests/support/catch.h"

/// What readers of files say.
namespace mesocell::test {

inline bool says(const std::string& message, std::string_view what) {
  INFO(message);
  return message.find(what) != std::string::npos;
}

inline bool has(const MeshReadReport& report, std::string_view id) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const MeshWarning& warning) { return warning.id == id; });
}

}  // namespace mesocell::test
