#include "sdk/core/recipe.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

namespace mesocell {
namespace {

Error usage(std::string text) { return {ErrorCode::kUsage, std::move(text)}; }

template <typename T>
bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

Result<Recipe> parse_recipe(std::string_view text) {
  Recipe recipe;
  const std::size_t colon = text.find(':');
  recipe.name = text.substr(0, colon);
  if (recipe.name.empty()) return usage("a recipe begins with a name, as in voronoi:cells=8");
  if (colon == std::string_view::npos) return recipe;
  text.remove_prefix(colon + 1);
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == item.size())
      return usage("option '" + std::string(item) + "' of " + recipe.name + " is not of the form name=value");
    if (!recipe.options.emplace(item.substr(0, equals), item.substr(equals + 1)).second)
      return usage("option '" + std::string(item.substr(0, equals)) + "' of " + recipe.name +
                   " is given twice");
    if (comma == std::string_view::npos) return recipe;
    text.remove_prefix(comma + 1);
  }
}

std::string to_text(const Recipe& recipe) {
  std::string text = recipe.name;
  char separator = ':';
  for (const auto& [name, value] : recipe.options) text += std::exchange(separator, ',') + name + "=" + value;
  return text;
}

Result<double> number_option(const Recipe& recipe, const std::string& name, double fallback, double low,
                             double high) {
  const auto given = recipe.options.find(name);
  if (given == recipe.options.end()) return fallback;
  double number = 0;
  if (!parse(given->second, number) || !(number >= low && number <= high)) {
    char range[64];
    std::snprintf(range, sizeof range, "%g to %g", low, high);
    return usage(name + "=" + given->second + " is not a number from " + range);
  }
  return number;
}

Result<std::uint64_t> whole_option(const Recipe& recipe, const std::string& name, std::uint64_t fallback,
                                   std::uint64_t low, std::uint64_t high) {
  const auto given = recipe.options.find(name);
  if (given == recipe.options.end()) return fallback;
  std::uint64_t number = 0;
  if (!parse(given->second, number) || number < low || number > high)
    return usage(name + "=" + given->second + " is not a whole number from " + std::to_string(low) + " to " +
                 std::to_string(high));
  return number;
}

Result<Index3> resolution_option(const Recipe& recipe, const std::string& name, const Index3& fallback,
                                 std::uint32_t low, std::uint32_t high) {
  const auto given = recipe.options.find(name);
  if (given == recipe.options.end()) return fallback;
  const Error error = usage(name + "=" + given->second + " is not a number of voxels from " +
                            std::to_string(low) + " to " + std::to_string(high) + ", nor WxHxD of such");
  std::string_view rest = given->second;
  Index3 resolution{};
  std::size_t count = 0;
  for (bool more = true; more; ++count) {
    const std::size_t x = rest.find('x');
    more = x != rest.npos;
    if (count == 3 || !parse(rest.substr(0, x), resolution[count]) || resolution[count] < low ||
        resolution[count] > high)
      return error;
    if (more) rest.remove_prefix(x + 1);
  }
  if (count == 1) return Index3{resolution[0], resolution[0], resolution[0]};
  return count == 3 ? Result<Index3>(resolution) : Result<Index3>(error);
}

Result<std::optional<Vec3>> point_option(const Recipe& recipe, const std::string& name) {
  const auto given = recipe.options.find(name);
  if (given == recipe.options.end()) return std::optional<Vec3>();
  std::string_view rest = given->second;
  Vec3 point;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t x = rest.find('x');
    if ((x == rest.npos) != (a == 2) || !parse(rest.substr(0, x), point[a]) || !std::isfinite(point[a]))
      return usage(name + "=" + given->second + " is not a point; write XxYxZ, for example 0.5x-1x2");
    if (a < 2) rest.remove_prefix(x + 1);
  }
  return std::optional<Vec3>(point);
}

Result<std::size_t> choice_option(const Recipe& recipe, const std::string& name,
                                  std::initializer_list<std::string_view> choices) {
  const auto given = recipe.options.find(name);
  if (given == recipe.options.end()) return std::size_t{0};
  std::string all;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const std::string_view choice = choices.begin()[i];
    if (choice == given->second) return i;
    all += (all.empty() ? "" : ", ") + std::string(choice);
  }
  return usage(name + "=" + given->second + " is not one of: " + all);
}

Status check_options(const Recipe& recipe, std::string_view kind, std::span<const std::string_view> names) {
  for (const auto& [name, value] : recipe.options) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string all;
    for (const std::string_view n : names)
      if (!n.empty()) all += (all.empty() ? "" : ", ") + std::string(n);
    return usage(std::string(kind) + " " + recipe.name + " has no option '" + name + "'; it has: " + all);
  }
  return {};
}

}  // namespace mesocell
