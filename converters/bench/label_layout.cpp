#include "converters/bench/label_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mesocell {
namespace {

constexpr double kHeight = 15, kMark = 6, kGap = 9;

double overlap(const PixelBox& a, const PixelBox& b) {
  const double x = std::min(a.x1, b.x1) - std::max(a.x0, b.x0),
               y = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  return x > 0 && y > 0 ? x * y : 0;
}

/// How much of a box is not in the area.
double outside(const PixelBox& box, const PixelBox& area) {
  return (box.x1 - box.x0) * (box.y1 - box.y0) - overlap(box, area);
}

}  // namespace

double text_width(const std::string& text) { return 6.9 * double(text.size()); }

std::vector<PlacedLabel> place_labels(std::span<const LabelAnchor> points, std::span<const PixelBox> lines,
                                      const PixelBox& area) {
  // Beside, above, below, then ever farther off.
  std::vector<std::array<double, 2>> places;  // -1 left, 0 middle, 1 right; and a height
  for (const double height :
       {0.0, 11.0, -11.0, 18.0, -18.0, 30.0, -30.0, 45.0, -45.0, 60.0, -60.0, 80.0, -80.0})
    for (const double side : {1.0, -1.0, 0.0})
      if (side != 0 || height != 0) places.push_back({side, height});
  std::vector<PixelBox> taken;
  for (const LabelAnchor& p : points) taken.push_back({p.x - kMark, p.y - kMark, p.x + kMark, p.y + kMark});
  std::vector<PlacedLabel> labels;
  for (const LabelAnchor& p : points) {
    const double width = text_width(p.text);
    double least = std::numeric_limits<double>::infinity();
    PixelBox best;
    for (const auto& [side, height] : places) {
      const double left = side > 0 ? p.x + kGap : side < 0 ? p.x - kGap - width : p.x - width / 2;
      const PixelBox box{left, p.y + height - kHeight / 2, left + width, p.y + height + kHeight / 2};
      double cost = 1000 * outside(box, area) + 0.3 * std::abs(height);
      for (const PixelBox& other : taken) cost += 10 * overlap(box, other);
      for (const PixelBox& line : lines) cost += 0.1 * overlap(box, line);
      if (cost >= least) continue;
      least = cost;
      best = box;
    }
    taken.push_back(best);
    labels.push_back({p.text, best.x0, (best.y0 + best.y1) / 2});
  }
  return labels;
}

}  // namespace mesocell
