#pragma once

#include <string_view>

namespace mesocell {

/// What the first bytes of a file say it is: "a PNG image", "a PLY mesh", …; empty if they say nothing.
/// Untrusted input: safe.
[[nodiscard]] std::string_view sniff_content(std::string_view bytes);

}  // namespace mesocell
