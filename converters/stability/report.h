#pragma once

#include <span>
#include <string>
#include <vector>

#include "converters/stability/measure.h"

namespace mesocell {

/// Results by rows and methods, those of several meshes joined.
struct StabilityTable {
  struct Cell {
    bool measured = false;  ///< there is a result
    bool too_long = false;  ///< on one of the meshes at least
    bool failed = false;    ///< the same
    WrongVoxels voxels;     ///< of the meshes on which it was done
    double seconds = 0;     ///< sum
  };
  struct Row {
    std::string group, name;
    std::vector<Cell> cells;  ///< one a method
  };
  std::vector<std::string> methods;
  std::vector<Row> rows;  ///< in the order of the results
};
[[nodiscard]] StabilityTable tabulate(std::span<const StabilityResult> results);

/// A field of CSV, in quotes if it must be.
[[nodiscard]] std::string csv_field(const std::string& text);

/// Per cent for people: "0", "<0.01", "0.03", "1.2", "35". A number that is not 0 does not become "0".
[[nodiscard]] std::string percent_text(double percent);

/// What a cell of a table shows: a share of wrong voxels, "too long" or "failed".
[[nodiscard]] std::string cell_text(const StabilityTable::Cell& cell);

/// A line a result, with a head line of names; fields with commas or quotes are quoted.
[[nodiscard]] std::string stability_csv(std::span<const StabilityResult> results);

/// Two tables: wrong voxels in per cent of those inside, and wrong ones far from the surface in per cent of
/// all that are far.
[[nodiscard]] std::string stability_markdown(const StabilityTable& table);

/// A line a result with time, peak memory and wrong voxels.
[[nodiscard]] std::string benchmark_markdown(std::span<const StabilityResult> results);

/// The first of stability_markdown()'s tables as a picture, SVG 1.1, with a scale of colors.
[[nodiscard]] std::string stability_heat_map(const StabilityTable& table, std::string_view caption);

}  // namespace mesocell
