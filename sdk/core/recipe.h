#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/vec.h"

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

/// Voxels along x, y, z in an option, "128" for all three or "96x64x128", each from `low` to `high`.
/// Errors: kUsage.
[[nodiscard]] Result<Index3> resolution_option(const Recipe& recipe, const std::string& name,
                                               const Index3& fallback, std::uint32_t low, std::uint32_t high);

/// The point in an option, "0.5x-1x2"; none if it is not given. Errors: kUsage.
[[nodiscard]] Result<std::optional<Vec3>> point_option(const Recipe& recipe, const std::string& name);

/// Which of `choices` an option is, the first if it is not given. Errors: kUsage if it is none of them.
[[nodiscard]] Result<std::size_t> choice_option(const Recipe& recipe, const std::string& name,
                                                std::initializer_list<std::string_view> choices);

/// Errors: kUsage if an option is not among `names`, of which empty ones do not count; it says
/// which there are.
[[nodiscard]] Status check_options(const Recipe& recipe, std::string_view kind,
                                   std::span<const std::string_view> names);

}  // namespace mesocell
