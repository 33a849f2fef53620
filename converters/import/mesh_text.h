#pragma once

#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>

#include "format/result.h"
#include "sdk/core/progress.h"

/// Lines, words and numbers of text mesh formats. No allocation, any bytes are allowed.
namespace mesocell {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Takes the next word off `line`; empty at its end.
inline std::string_view next_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// The rest of a line without blanks around it, for names, which may hold some.
inline std::string_view trimmed(std::string_view rest) {
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
  return rest;
}

/// Walks over the lines of a text; "\n", "\r\n" and "\r" end a line.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    const std::size_t end = text_.find_first_of("\n\r", at_);
    line = text_.substr(at_, end == text_.npos ? text_.npos : end - at_);
    at_ = end == text_.npos ? text_.size() : end + 1;
    if (end != text_.npos && text_[end] == '\r' && at_ < text_.size() && text_[at_] == '\n') ++at_;
    ++number_;
    return true;
  }
  /// Number of the line that next() gave, from 1.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// Offset of the byte after that line.
  [[nodiscard]] std::size_t offset() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::uint64_t number_ = 0;
};

/// Parses a whole word as a number; "nan", "inf" and numbers beyond the range of double give non-finite
/// values.
inline bool parse_number(std::string_view word, double& value) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return false;
  // from_chars leaves the value alone when it is out of range: too large and too small look alike.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(word).c_str(), nullptr);
  return error != std::errc::invalid_argument;
}

inline bool parse_integer(std::string_view word, std::int64_t& value) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && error == std::errc() && end == word.data() + word.size();
}

/// Whether the library's single precision can hold a coordinate; others are handed to it as 0.
inline bool library_holds(double x) { return std::abs(x) <= double{FLT_MAX}; }

inline Error invalid_mesh(std::string message) { return Error{ErrorCode::kInvalidInput, std::move(message)}; }

inline Error invalid_line(std::uint64_t line, const std::string& message) {
  return invalid_mesh("line " + std::to_string(line) + ": " + message);
}

inline Error cancelled() { return Error{ErrorCode::kCancelled, "interrupted"}; }

/// Whether to stop, asked once every few thousand lines.
inline bool stop_at(const Progress* progress, std::uint64_t count) {
  return (count & 0xfff) == 0 && progress && progress->cancelled();
}

}  // namespace mesocell
