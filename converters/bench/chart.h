#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "converters/bench/table_reader.h"
#include "format/result.h"

namespace mesocell {

enum class ChartError : std::uint8_t {
  kWrong,  ///< share of rays that miss what they should hit, hit what is not there, or hit another cell
  kDepth,  ///< the greatest error in depth, voxels
};

/// Which rows of a benchmark are charted; empty for all, but of rays for "primary" if there are such, and of
/// threads for the greatest number.
struct ChartRows {
  std::string scene, camera, rays;
  std::optional<unsigned> threads;
  ChartError error = ChartError::kWrong;
};

/// A figure over several scenes and cameras.
struct ChartRange {
  double median = 0, low = 0, high = 0;
};

/// What is told of a method.
struct ChartMethod {
  std::string name;
  std::size_t rows = 0;
  ChartRange speed;   ///< rays a second
  ChartRange memory;  ///< bytes
  ChartRange error;
  /// Degrees between rays and surface, ascending, and steps a ray; of one scene. Empty where they are not
  /// counted.
  std::vector<std::pair<double, double>> steps;
};

struct Chart {
  std::vector<ChartMethod> methods;  ///< by name
  ChartError error = ChartError::kWrong;
  bool only_missed = false;  ///< kWrong counts hits missed alone, as the table has no more
  std::string subject;       ///< scene, camera, rays, threads
  std::string steps_scene;   ///< what the steps are of; empty if there is no curve of them
  std::string processor;     ///< empty if it is not told
};

/// Sums a benchmark's CSV up. Errors: kInvalidInput (a column that is needed is not there, a number is none),
/// kUsage (no row is as asked for; says what there is).
[[nodiscard]] Result<Chart> make_chart(const TextTable& table, const ChartRows& wanted);

/// Parts of a picture.
struct ChartPicture {
  bool pareto = true, memory = true, steps = true;
  bool png = false;  ///< else SVG
};

/// The script that draws a chart by gnuplot. Texts of the table are safe in it.
[[nodiscard]] std::string chart_script(const Chart& chart, const ChartPicture& picture);

}  // namespace mesocell
