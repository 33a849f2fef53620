#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "format/result.h"
#include "sdk/core/vec.h"

/// Values of options that are more than one number.
namespace mesocell {

/// The words between commas; empty ones do not count.
[[nodiscard]] inline std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t comma = std::min(list.find(',', begin), list.size());
    if (comma > begin) words.push_back(list.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return words;
}

/// Parses N finite numbers with commas between them and nothing else. Errors: kUsage.
template <std::size_t N>
[[nodiscard]] Result<std::array<double, N>> parse_numbers(std::string_view text) {
  const Error error{ErrorCode::kUsage,
                    "'" + std::string(text) + "' is not " + std::to_string(N) +
                        " finite numbers with commas between them; write for example 1,0.5,-2" +
                        (N == 6   ? ",3,2.5,0"
                         : N == 4 ? ",0.5"
                                  : "")};
  std::array<double, N> values{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t comma = rest.find(',');
    if ((comma == rest.npos) != (i + 1 == N)) return error;
    std::string_view word = rest.substr(0, comma);
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), values[i]);
    if (word.empty() || status != std::errc() || end != word.data() + word.size() ||
        !std::isfinite(values[i]))
      return error;
    rest.remove_prefix(comma == rest.npos ? rest.size() : comma + 1);
  }
  return values;
}

[[nodiscard]] inline Result<Vec3> parse_vec3(std::string_view text) {
  const Result<std::array<double, 3>> numbers = parse_numbers<3>(text);
  if (!numbers) return numbers.error();
  return to_vec3(*numbers);
}

/// Parses a size of a picture, "1024x768", each from 1 to 16384. Errors: kUsage.
[[nodiscard]] inline Result<std::array<std::uint32_t, 2>> parse_size(std::string_view text) {
  const Error error{ErrorCode::kUsage,
                    "'" + std::string(text) +
                        "' is not a size; write WIDTHxHEIGHT, each from 1 to 16384, for example "
                        "1024x768"};
  std::array<std::uint32_t, 2> size{};
  const std::size_t x = text.find('x');
  if (x == text.npos) return error;
  const std::array<std::string_view, 2> words = {text.substr(0, x), text.substr(x + 1)};
  for (std::size_t i = 0; i < 2; ++i) {
    const char* last = words[i].data() + words[i].size();
    const auto [end, status] = std::from_chars(words[i].data(), last, size[i]);
    if (words[i].empty() || status != std::errc() || end != last || size[i] < 1 || size[i] > 16384)
      return error;
  }
  return size;
}

}  // namespace mesocell
