#pragma once

#include <string>

/// The parts of the spec that are made from code: spec/issues.md and the walk-through of section 7.
namespace mesocell::test {

inline constexpr char kWalkthroughBegin[] = "<!-- generated: walk-through -->\n";
inline constexpr char kWalkthroughEnd[] = "<!-- end of the generated part -->\n";

/// The file of section 7, section by section, 16 bytes a line: "0140  89 4d …".
[[nodiscard]] std::string walkthrough_markdown();

}  // namespace mesocell::test
