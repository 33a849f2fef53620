#include "converters/bench/table_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace mesocell {
namespace {

constexpr std::size_t kMostColumns = 1000, kMostRows = 1000000;

Error bad_line(std::size_t line, const std::string& text) {
  return Error{ErrorCode::kInvalidInput, "line " + std::to_string(line) + ": " + text};
}

/// Splits the next line off; false at the end.
bool next_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const std::size_t end = text.find('\n');
  line = text.substr(0, end);
  text.remove_prefix(end == text.npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

/// The fields of a line; a quoted one must end on it.
Status split(std::string_view line, std::size_t number, std::vector<std::string>& fields) {
  fields.clear();
  for (;;) {
    if (fields.size() == kMostColumns)
      return bad_line(number,
                      "it has over " + std::to_string(kMostColumns) + " columns, which no benchmark writes");
    std::string field;
    if (line.starts_with('"')) {
      line.remove_prefix(1);
      for (;;) {
        const std::size_t quote = line.find('"');
        if (quote == line.npos) return bad_line(number, "a quoted text does not end");
        field += line.substr(0, quote);
        line.remove_prefix(quote + 1);
        if (!line.starts_with('"')) break;
        field += '"';
        line.remove_prefix(1);
      }
      if (!line.empty() && !line.starts_with(','))
        return bad_line(number, "there is text after a quoted one");
    } else {
      const std::size_t comma = std::min(line.find(','), line.size());
      field = line.substr(0, comma);
      line.remove_prefix(comma);
    }
    fields.push_back(std::move(field));
    if (line.empty()) return {};
    line.remove_prefix(1);
  }
}

}  // namespace

std::optional<std::size_t> TextTable::find(std::string_view column) const {
  const auto found = std::ranges::find(columns, column);
  if (found == columns.end()) return std::nullopt;
  return std::size_t(found - columns.begin());
}

Result<TextTable> parse_table(std::string_view text) {
  TextTable table;
  if (const std::size_t zero = text.find('\0'); zero != text.npos)
    return bad_line(std::size_t(std::ranges::count(text.substr(0, zero), '\n')) + 1,
                    "it has a byte that is no text; give the CSV of mesocell bench");
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::string_view line;
  for (std::size_t number = 1; next_line(text, line); ++number) {
    if (line.empty()) continue;
    if (line.starts_with('#')) {
      if (table.columns.empty() && table.head.size() < kMostColumns) table.head.emplace_back(line.substr(1));
      continue;
    }
    if (table.columns.empty()) {
      if (const Status status = split(line, number, table.columns); !status) return status.error();
      std::vector<std::string> sorted = table.columns;
      std::ranges::sort(sorted);
      if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end())
        return bad_line(number, "the column '" + twice->substr(0, 60) + "' is there twice");
      continue;
    }
    if (table.rows.size() == kMostRows)
      return bad_line(number, "there are over " + std::to_string(kMostRows) + " rows");
    TextTable::Row row{number, {}};
    if (const Status status = split(line, number, row.fields); !status) return status.error();
    if (row.fields.size() != table.columns.size())
      return bad_line(number, "it has " + std::to_string(row.fields.size()) + " fields, but there are " +
                                  std::to_string(table.columns.size()) + " columns");
    table.rows.push_back(std::move(row));
  }
  if (table.columns.empty())
    return Error{ErrorCode::kInvalidInput, "it has no line of column names; give the CSV of mesocell bench"};
  if (table.rows.empty())
    return Error{ErrorCode::kInvalidInput, "it has no rows; give the CSV of a run that measured something"};
  return table;
}

Result<std::optional<double>> number_at(const TextTable& table, const TextTable::Row& row,
                                        std::size_t column) {
  const std::string& text = row.fields[column];
  if (text.empty()) return std::optional<double>();
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x) || x < 0)
    return bad_line(row.line, "'" + text.substr(0, 60) + "' in column " + table.columns[column] +
                                  " is no number of at least 0");
  return std::optional(x);
}

}  // namespace mesocell
