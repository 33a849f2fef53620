#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "converters/cli/representations.h"
#include "format/cell_object.h"

/// What the command knows of cell objects.
namespace mesocell {

/// Decodes the asset of a container, which must be a cell object. Untrusted input: safe. Errors:
/// kInvalidInput, kLimit.
[[nodiscard]] Result<std::unique_ptr<Asset>> load_cell_object(const Container& container,
                                                              const ReadLimits& limits, std::size_t asset);

/// The rule of membership of that name, "centre" or "conservative". [spec 4.3]
[[nodiscard]] std::optional<MembershipRule> find_rule(std::string_view name);

/// All names of rules, with commas between them.
[[nodiscard]] std::string rule_names();

/// The keys that compare() of a cell object adds, for help texts.
[[nodiscard]] const char* cell_object_comparison_help();

}  // namespace mesocell
