#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mesocell {

/// A table of shares as a picture.
struct HeatMap {
  struct Cell {
    std::optional<double> percent;  ///< its color; grey if there is none
    std::string text;
  };
  struct Row {
    std::string group;  ///< its title stands where it changes
    std::string name;
    std::vector<Cell> cells;  ///< one a column
  };
  std::string title, caption;
  std::string legend;  ///< what the shares are of
  std::vector<std::string> columns;
  std::vector<Row> rows;
  int column_width = 104;  ///< pixels
};

/// SVG 1.1, with a scale of colors, logarithmic from 0.01 to 100 %.
[[nodiscard]] std::string draw_heat_map(const HeatMap& map);

}  // namespace mesocell
