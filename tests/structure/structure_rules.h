#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mesocell::test {

/// What a source file does against the rules of the folders, a sentence each: who may include whom, which
/// folder may see which third party, and no more than 500
/// lines (1000 for the compact loader). `path` is relative to the project's root.
[[nodiscard]] std::vector<std::string> broken_rules(const std::string& path, std::string_view text);

/// A quoted include of a source, as it is written.
[[nodiscard]] std::vector<std::string> quoted_includes(std::string_view text);

}  // namespace mesocell::test
