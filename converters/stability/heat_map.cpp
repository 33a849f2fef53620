#include "converters/stability/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace mesocell {
namespace {

// Pixels.
constexpr int kLabelWidth = 250, kCellHeight = 19, kHead = 92, kGroupGap = 24, kMargin = 14, kLegend = 64,
              kLegendWidth = 624;

struct Color {
  int r, g, b;
};

/// Steps of the scale, per cent, and their colors: from what does not show to what cannot be used.
struct Step {
  double percent;
  Color color;
};
constexpr std::array kScale = {Step{0.01, {229, 245, 224}}, Step{0.1, {199, 227, 160}},
                               Step{1, {254, 224, 139}}, Step{10, {244, 138, 78}}, Step{100, {178, 24, 43}}};
constexpr Color kZero = {255, 255, 255}, kNothing = {205, 205, 205};

/// Between the steps by the logarithm.
Color color_of(double percent) {
  if (percent <= 0) return kZero;
  if (percent <= kScale.front().percent) return kScale.front().color;
  for (std::size_t k = 1; k < kScale.size(); ++k) {
    if (percent > kScale[k].percent) continue;
    const Color &a = kScale[k - 1].color, &b = kScale[k].color;
    const double s = std::log10(percent / kScale[k - 1].percent);
    const auto mix = [&](int from, int to) { return int(std::lround(from + s * (to - from))); };
    return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
  }
  return kScale.back().color;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) >= ' ')
      out += c;
  }
  return out;
}

class Svg {
 public:
  Svg(int width, int height) {
    const std::string size =
        "width=\"" + std::to_string(width) + "\" height=\"" + std::to_string(height) + "\"";
    text_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" " + size + " viewBox=\"0 0 " +
            std::to_string(width) + " " + std::to_string(height) +
            "\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\">\n<rect " + size +
            " fill=\"#fff\"/>\n";
  }
  void rectangle(int x, int y, int width, int height, Color color) {
    char line[160];
    std::snprintf(
        line, sizeof line,
        "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#%02x%02x%02x\" stroke=\"#ddd\"/>\n", x, y,
        width, height, unsigned(color.r), unsigned(color.g), unsigned(color.b));
    text_ += line;
  }
  void text(int x, int y, std::string_view text, const char* attributes) {
    text_ += "<text x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" " + attributes + ">" +
             escaped(text) + "</text>\n";
  }
  [[nodiscard]] std::string finish() && { return std::move(text_) + "</svg>\n"; }

 private:
  std::string text_;
};

const char* ink(Color c) { return 3 * c.r + 6 * c.g + c.b < 1100 ? "#fff" : "#222"; }

void add_legend(Svg& svg, int y, std::string_view legend) {
  svg.text(kMargin, y + 13, legend, "fill=\"#444\"");
  int x = kMargin + kLabelWidth;
  const auto box = [&](Color color, const char* text) {
    svg.rectangle(x, y, 22, kCellHeight, color);
    svg.text(x + 28, y + 13, text, "fill=\"#444\"");
    x += 84;
  };
  box(kZero, "0");
  for (const Step& step : kScale) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", step.percent);
    box(step.color, text);
  }
  box(kNothing, "no result");
}

}  // namespace

std::string draw_heat_map(const HeatMap& map) {
  int groups = 0;
  for (std::size_t r = 0; r < map.rows.size(); ++r)
    groups += r == 0 || map.rows[r].group != map.rows[r - 1].group;
  const int columns = int(map.columns.size()), cell_width = map.column_width;
  const int width = 2 * kMargin + kLabelWidth + std::max(columns * cell_width, kLegendWidth);
  const int height = kHead + groups * kGroupGap + int(map.rows.size()) * kCellHeight + kLegend;
  Svg svg(width, height);
  svg.text(kMargin, 26, map.title, "font-size=\"17\" fill=\"#111\"");
  svg.text(kMargin, 46, map.caption, "fill=\"#444\"");
  for (int m = 0; m < columns; ++m)
    svg.text(kMargin + kLabelWidth + m * cell_width + cell_width / 2, kHead - 16, map.columns[std::size_t(m)],
             "text-anchor=\"middle\" font-weight=\"bold\" fill=\"#111\"");
  int y = kHead - 8;
  for (std::size_t r = 0; r < map.rows.size(); ++r) {
    const HeatMap::Row& row = map.rows[r];
    if (r == 0 || row.group != map.rows[r - 1].group) {
      y += kGroupGap;
      svg.text(kMargin, y - 7, row.group, "font-weight=\"bold\" fill=\"#444\"");
    }
    svg.text(kMargin + kLabelWidth - 8, y + 14, row.name, "text-anchor=\"end\" fill=\"#111\"");
    for (int m = 0; m < columns; ++m) {
      const HeatMap::Cell& cell = row.cells[std::size_t(m)];
      const Color color = cell.percent ? color_of(*cell.percent) : kNothing;
      const int x = kMargin + kLabelWidth + m * cell_width;
      svg.rectangle(x, y, cell_width, kCellHeight, color);
      const std::string attributes = std::string("text-anchor=\"middle\" fill=\"") + ink(color) + "\"";
      svg.text(x + cell_width / 2, y + 14, cell.text, attributes.c_str());
    }
    y += kCellHeight;
  }
  add_legend(svg, y + 20, map.legend);
  return std::move(svg).finish();
}

}  // namespace mesocell
