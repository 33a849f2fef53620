#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "format/result.h"

namespace mesocell {

/// What to make and how, as written on the command line: "voronoi:cells=8,resolution=128,seed=1".
struct Recipe {
  std::string name;
  std::map<std::string, std::string> options;
};

/// Splits the text of a recipe. Errors: kUsage with what is wrong in it. Trust: any text.
[[nodiscard]] Result<Recipe> parse_recipe(std::string_view text);

/// The recipe's text with its options in order, so that equal recipes are written alike.
[[nodiscard]] std::string to_text(const Recipe& recipe);

/// The number in an option, `fallback` if it is not given.
/// Errors: kUsage if it is not a number in [low, high].
[[nodiscard]] Result<double> number_option(const Recipe& recipe, const std::string& name, double fallback,
                                           double low, double high);
/// The whole number in an option, likewise.
[[nodiscard]] Result<std::uint64_t> whole_option(const Recipe& recipe, const std::string& name,
                                                 std::uint64_t fallback, std::uint64_t low,
                                                 std::uint64_t high);

/// Errors: kUsage if an option is not among `names`; it says which there are.
[[nodiscard]] Status check_options(const Recipe& recipe, std::string_view kind,
                                   std::span<const std::string_view> names);

}  // namespace mesocell
