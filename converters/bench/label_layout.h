#pragma once

#include <span>
#include <string>
#include <vector>

namespace mesocell {

/// A rectangle of a picture; pixels, y upwards.
struct PixelBox {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// A name beside a point of a chart.
struct PlacedLabel {
  std::string text;
  double x = 0, y = 0;  ///< left end, middle of the height
};

struct LabelAnchor {
  std::string text;
  double x = 0, y = 0;
};

/// Width of a text in the charts' font, about.
[[nodiscard]] double text_width(const std::string& text);

/// Places a label beside each point within `area`, such that they cover neither points nor each other, and
/// few of the `lines`, where there is room.
[[nodiscard]] std::vector<PlacedLabel> place_labels(std::span<const LabelAnchor> points,
                                                    std::span<const PixelBox> lines, const PixelBox& area);

}  // namespace mesocell
