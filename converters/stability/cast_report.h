#pragma once

#include <span>
#include <string>

#include "converters/stability/cast_measure.h"

namespace mesocell {

/// A line a result, with a head line of names.
[[nodiscard]] std::string cast_csv(std::span<const CastResult> results);

/// Two tables, cases by methods: verdicts with the share of wrong rays, and figures of what is not answered
/// right.
[[nodiscard]] std::string cast_markdown(std::span<const CastResult> results);

/// The verdicts as a picture, SVG 1.1.
[[nodiscard]] std::string cast_heat_map(std::span<const CastResult> results, std::string_view caption);

}  // namespace mesocell
