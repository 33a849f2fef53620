#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "converters/cli/shape_source.h"

namespace mesocell {

/// What --heights says.
struct HeightPlan {
  bool as_mesh = false, black_up = false, scaled = true;
  std::optional<double> spacing, scale, zero, floor, no_data, gamma;
  std::string channel;
};

/// Parses "scale=2,up=black". Errors: kUsage.
[[nodiscard]] Result<HeightPlan> parse_height_plan(const std::string& text);

/// Reads a picture as heights, as the shape that the plan asks for; remarks are added to `warnings`
/// and `notes`. Untrusted input: safe.
[[nodiscard]] std::optional<Failure> read_heights(const std::string& input, const HeightPlan& plan,
                                                  const Progress& progress,
                                                  std::unique_ptr<ShapeSource>& shape,
                                                  std::vector<Warning>& warnings, ReadNotes& notes);

/// The keys of --heights, for help texts.
[[nodiscard]] std::string heights_help();

}  // namespace mesocell
