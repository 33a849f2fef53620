#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"

namespace mesocell {

/// Natural order of names: runs of digits are compared as numbers, so slice2 comes before slice10; all else
/// by bytes, the same in every language. Equal but for leading zeros, the bytes decide.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

/// Names of the files in a folder of slices, in natural order. Hidden ones, which begin with a dot, are
/// passed over; all others must have an extension from `extensions` (lower case, with the dot; any case in
/// the folder), and all the same. Errors: kUnreadable, kInvalidInput (none, another extension, mixed ones),
/// kLimit (over `max_slices`).
[[nodiscard]] Result<std::vector<std::string>> list_slices(const std::string& folder,
                                                           const std::vector<std::string>& extensions,
                                                           std::uint32_t max_slices);

}  // namespace mesocell
