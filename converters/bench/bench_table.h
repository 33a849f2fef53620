#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "converters/bench/bench.h"

namespace mesocell {

/// A column of the result, for CSV and JSON alike.
struct BenchColumn {
  std::string_view name;
  bool is_text = false;  ///< else a number, or empty where it is not known
  std::string (*text)(const BenchRow& row);
};
[[nodiscard]] std::span<const BenchColumn> bench_columns();

/// What a run was, by name and text: program, date, machine…
using BenchHead = std::vector<std::pair<std::string, std::string>>;

/// Head lines that begin with '#', a line of names, then a line a row.
[[nodiscard]] std::string bench_csv(const BenchHead& head, std::span<const BenchRow> rows);

/// The figures that matter, as a table for people.
[[nodiscard]] std::string bench_markdown(const BenchHead& head, std::span<const BenchRow> rows);

}  // namespace mesocell
