#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"

namespace mesocell {

/// A table of text: CSV with a line of names, after lines that begin with '#'.
struct TextTable {
  struct Row {
    std::size_t line = 0;  ///< in the text, from 1
    std::vector<std::string> fields;
  };

  std::vector<std::string> head;     ///< lines that begin with '#', without it
  std::vector<std::string> columns;  ///< names, unique
  std::vector<Row> rows;             ///< as many fields as there are columns

  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;
};

/// Reads CSV, fields quoted or not, lines ended by LF or CRLF. Untrusted input: safe. Errors: kInvalidInput
/// with the line (no names, no rows, a name twice, over 1000 columns or a million rows, rows of another
/// length, a quote that does not end, a byte that is no text).
[[nodiscard]] Result<TextTable> parse_table(std::string_view text);

/// A field as a finite number of at least 0; nothing if it is empty. Errors: kInvalidInput with line and
/// column.
[[nodiscard]] Result<std::optional<double>> number_at(const TextTable& table, const TextTable::Row& row,
                                                      std::size_t column);

}  // namespace mesocell
