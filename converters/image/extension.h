#pragma once

#include <string>

namespace mesocell {

/// The extension of a path with its dot, in lower case; empty if it has none.
[[nodiscard]] std::string lower_extension(const std::string& path);

}  // namespace mesocell
