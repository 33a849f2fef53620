#include "converters/import/slice_stack.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "converters/image/extension.h"

namespace mesocell {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes a run of digits off the front of `text`; returns it without leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::string_view x = a, y = b;
  while (!x.empty() && !y.empty()) {
    if (is_digit(x[0]) && is_digit(y[0])) {
      const std::string_view m = take_number(x), n = take_number(y);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
      continue;
    }
    if (x[0] != y[0]) return std::uint8_t(x[0]) < std::uint8_t(y[0]);
    x.remove_prefix(1);
    y.remove_prefix(1);
  }
  return x.empty() != y.empty() ? x.empty() : a < b;
}

Result<std::vector<std::string>> list_slices(const std::string& folder,
                                             const std::vector<std::string>& extensions,
                                             std::uint32_t max_slices) {
  const auto invalid = [](std::string message) {
    return Error{ErrorCode::kInvalidInput, std::move(message)};
  };
  std::string known;
  for (const std::string& extension : extensions) known += (known.empty() ? "" : ", ") + extension;
  std::vector<std::string> names;
  // Whatever order the system lists them in, the same one is named.
  std::string stranger;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::string name = it->path().filename().string();
    if (name.starts_with('.')) continue;
    if (std::find(extensions.begin(), extensions.end(), lower_extension(name)) == extensions.end()) {
      if (stranger.empty() || natural_less(name, stranger)) stranger = name;
      continue;
    }
    if (names.size() == max_slices)
      return Error{ErrorCode::kLimit, "the folder has more than " + std::to_string(max_slices) +
                                          " pictures, which are slices; take fewer"};
    names.push_back(std::move(name));
  }
  if (error)
    return Error{ErrorCode::kUnreadable,
                 "the folder cannot be read (" + error.message() + "); check its permissions"};
  if (!stranger.empty())
    return invalid("the folder has '" + stranger +
                   "', which is no slice; a stack holds nothing but pictures (" + known +
                   ") and hidden files, so move it away");
  if (names.empty()) return invalid("the folder has no pictures; each is a slice, as " + known);
  std::sort(names.begin(), names.end(), natural_less);
  for (const std::string& name : names)
    if (lower_extension(name) != lower_extension(names[0]))
      return invalid("the folder mixes pictures of several kinds, '" + names[0] + "' and '" + name +
                     "'; keep those of one extension");
  return names;
}

}  // namespace mesocell
