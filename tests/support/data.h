#pragma once

#include <optional>
#include <string>

namespace mesocell::test {

/// Path of a file of the optional test data ("meshes/fandisk.off"), if it is there: below the folder named by
/// MESOCELL_TEST_DATA, else below ../shared/data beside the project. A test without its data skips, and says
/// so.
[[nodiscard]] std::optional<std::string> find_data(const std::string& name);

}  // namespace mesocell::test
