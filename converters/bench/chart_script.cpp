#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "converters/bench/chart.h"
#include "converters/bench/gnuplot.h"
#include "converters/bench/label_layout.h"

namespace mesocell {
namespace {

constexpr double kWidth = 900;  // as wide as a page shows it
constexpr const char* kGrey = "#707070";

/// How a method is drawn: colors that the colour-blind tell apart, and a mark for each. [Okabe and Ito 2008]
struct Look {
  const char* color;
  int mark;  ///< gnuplot's point type
};

struct NamedLook {
  std::string_view family;
  Look look;
};
constexpr std::array<NamedLook, 8> kLooks = {{{"exact", {"#d55e00", 7}},
                                              {"linear", {"#0072b2", 9}},
                                              {"distance", {"#56b4e9", 11}},
                                              {"lod", {"#009e73", 5}},
                                              {"embree-instanced", {"#cc79a7", 13}},
                                              {"embree-surface", {"#cc79a7", 12}},
                                              {"openvdb", {"#555555", 5}},
                                              {"nanovdb", {"#555555", 4}}}};

/// "linear:1/512:angle" is of the family linear:angle, "linear:1/512" of linear.
std::string family_of(const std::string& name) {
  const std::string family = name.substr(0, name.find(':'));
  return name.ends_with(":angle") ? family + ":angle" : family;
}

Look look_of(const std::string& name) {
  const std::string family = name.substr(0, name.find(':'));
  for (const NamedLook& known : kLooks)
    if (known.family == family) {
      Look look = known.look;
      if (name.ends_with(":angle")) --look.mark;  // the same, hollow
      return look;
    }
  return {"#e69f00", 15};
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", x);
  return text;
}

/// A value with a unit's prefix.
std::string with_prefix(double x, const char* unit) {
  constexpr std::array<const char*, 5> kPrefixes = {"", "k", "M", "G", "T"};
  std::size_t k = 0;
  for (; k + 1 < kPrefixes.size() && x >= 999.5; ++k) x /= 1000;
  const std::string prefixed = std::string(kPrefixes[k]) + unit;
  return number(x) + (prefixed.empty() ? "" : " " + prefixed);
}

struct Tick {
  double at;         ///< on the axis
  std::string text;  ///< as a format of gnuplot: %% is a %
};

/// An axis of logarithms; what is 0 stands at its own place at the low end.
struct Axis {
  double low = 0, high = 1, zero = 0;
  std::vector<Tick> ticks;
  std::string title;

  [[nodiscard]] double at(double value) const { return value > 0 ? std::log10(value) : zero; }
};

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  bool zero = false;
  void add(double value) {
    if (value > 0) {
      low = std::min(low, value);
      high = std::max(high, value);
    } else {
      zero = true;
    }
  }
};

/// An axis with ticks at 1, 2 and 5, or at powers of ten alone where it is long.
Axis value_axis(Extent extent, const std::string& title, const char* unit) {
  Axis axis;
  axis.title = title;
  if (!(extent.high > 0)) extent.low = extent.high = 1;
  // At least such that two values are on it.
  const double room = std::max(0.08 * std::log10(extent.high / extent.low),
                               std::max(0.12, (0.7 - std::log10(extent.high / extent.low)) / 2));
  axis.low = std::log10(extent.low) - room;
  axis.high = std::log10(extent.high) + room;
  const bool few = axis.high - axis.low > 2.5;
  for (int k = int(std::floor(axis.low)); k <= int(std::ceil(axis.high)); ++k)
    for (const int part : {1, 2, 5}) {
      const double value = part * std::pow(10, k), at = std::log10(value);
      if ((few && part != 1) || at < axis.low || at > axis.high) continue;
      axis.ticks.push_back({at, with_prefix(value, unit)});
    }
  axis.zero = axis.low;
  return axis;
}

/// Errors by powers of ten, and 0 to the left of them.
Axis error_axis(const Extent& extent, const Chart& chart) {
  const bool share = chart.error == ChartError::kWrong;
  Axis axis;
  axis.title = !share              ? "greatest error in depth, voxels"
               : chart.only_missed ? "hits that are missed, % of hits"
                                   : "rays with a wrong answer, % of rays";
  double low = -4, high = -1;
  if (extent.high > 0) {
    low = std::floor(std::log10(extent.low));
    high = std::max(std::ceil(std::log10(extent.high)), low + 1);
  }
  axis.zero = low - 0.7;
  axis.low = extent.zero || extent.high == 0 ? low - 1.2 : low - 0.15;
  axis.high = high + 0.15;
  if (axis.low < axis.zero) axis.ticks.push_back({axis.zero, share ? "none" : "0"});
  const int every = high - low > 9 ? 2 : 1;
  for (int k = int(low); k <= int(high); k += every)
    axis.ticks.push_back({double(k), number(std::pow(10, share ? k + 2 : k)) + (share ? " %%" : "")});
  return axis;
}

/// One chart in the picture.
class Panel {
 public:
  /// `area`: where its curves are; `height`: of the picture.
  Panel(std::string& script, const PixelBox& area, double height)
      : script_(script), area_(area), height_(height) {}

  void begin(const std::string& title, const Axis& x, const Axis& y) {
    x_ = x;
    y_ = y;
    script_ += "unset label\nunset arrow\nset lmargin at screen " + number(area_.x0 / kWidth) +
               "\nset rmargin at screen " + number(area_.x1 / kWidth) + "\nset bmargin at screen " +
               number(area_.y0 / height_) + "\nset tmargin at screen " + number(area_.y1 / height_) + "\n";
    axis("x", x);
    axis("y", y);
    text(y.title, area_.x0 - 64, (area_.y0 + area_.y1) / 2, "center rotate by 90");
    text(title, area_.x0, area_.y1 + 16, "left font title_font");
  }

  void line(double ax, double ay, double bx, double by, const std::string& style) {
    script_ += "set arrow from " + number(ax) + "," + number(ay) + " to " + number(bx) + "," + number(by) +
               " nohead back " + style + "\n";
  }
  void text(const std::string& what, double x, double y, const std::string& style) {
    script_ += "set label " + gnuplot_text(what) + " at screen " + number(x / kWidth) + "," +
               number(y / height_) + " " + style + "\n";
  }
  /// A curve or points of axes' coordinates.
  void curve(const std::vector<std::pair<double, double>>& points, const std::string& style) {
    if (points.empty()) return;
    plots_ += std::string(plots_.empty() ? "plot " : ", ") + "'-' using 1:2 with " + style + " notitle";
    for (const auto& [x, y] : points) data_ += number(x) + " " + number(y) + "\n";
    data_ += "e\n";
  }
  void end() { script_ += plots_ + "\n" + data_; }

  [[nodiscard]] double pixel_x(double x) const {
    return area_.x0 + (x - x_.low) / (x_.high - x_.low) * (area_.x1 - area_.x0);
  }
  [[nodiscard]] double pixel_y(double y) const {
    return area_.y0 + (y - y_.low) / (y_.high - y_.low) * (area_.y1 - area_.y0);
  }
  [[nodiscard]] const PixelBox& area() const { return area_; }
  [[nodiscard]] const Axis& x() const { return x_; }
  [[nodiscard]] const Axis& y() const { return y_; }

 private:
  void axis(const std::string& name, const Axis& a) {
    script_ += "set " + name + "range [" + number(a.low) + ":" + number(a.high) + "]\n";
    if (name == "x") script_ += "set xlabel " + gnuplot_text(a.title) + "\n";
    script_ += "set " + name + "tics nomirror out scale 0.6 (";
    for (const Tick& tick : a.ticks)
      script_ += (&tick == a.ticks.data() ? "" : ", ") + gnuplot_text(tick.text) + " " + number(tick.at);
    script_ += ")\n";
  }

  std::string& script_;
  PixelBox area_;
  double height_;
  Axis x_, y_;
  std::string plots_, data_;
};

/// The methods that none is both faster (or smaller) and better than, by error.
std::vector<const ChartMethod*> front_of(const Chart& chart, ChartRange ChartMethod::*value,
                                         bool more_is_better) {
  std::vector<const ChartMethod*> order;
  for (const ChartMethod& m : chart.methods) order.push_back(&m);
  const auto worth = [&](const ChartMethod* m) { return (more_is_better ? 1 : -1) * (m->*value).median; };
  std::ranges::stable_sort(order, [&](const ChartMethod* a, const ChartMethod* b) {
    return a->error.median != b->error.median ? a->error.median < b->error.median : worth(a) > worth(b);
  });
  std::vector<const ChartMethod*> front;
  for (const ChartMethod* m : order)
    if (front.empty() || worth(m) > worth(front.back())) front.push_back(m);
  return front;
}

/// Methods by error and another figure.
void draw_against_error(Panel panel, const Chart& chart, const std::string& title,
                        ChartRange ChartMethod::*value, const Axis& y, bool more_is_better) {
  Extent errors;
  for (const ChartMethod& m : chart.methods)
    for (const double x : {m.error.median, m.error.low, m.error.high}) errors.add(x);
  const Axis x = error_axis(errors, chart);
  panel.begin(title, x, y);
  std::vector<std::pair<double, double>> steps;
  for (const ChartMethod* m : front_of(chart, value, more_is_better)) {
    const double at = x.at(m->error.median);
    if (!steps.empty()) steps.emplace_back(at, steps.back().second);
    steps.emplace_back(at, y.at((m->*value).median));
  }
  steps.emplace_back(x.high, steps.back().second);
  panel.curve(steps, "lines lw 6 lc rgb '#e4e4e4'");
  std::map<std::string, std::vector<std::pair<double, double>>> families;
  for (const ChartMethod& m : chart.methods)
    families[family_of(m.name)].emplace_back(x.at(m.error.median), y.at((m.*value).median));
  for (auto& [family, points] : families) {
    if (points.size() < 2) continue;
    std::ranges::sort(points);
    panel.curve(points, std::string("lines lw 1 dt 2 lc rgb '") + look_of(family).color + "'");
  }
  std::vector<LabelAnchor> anchors;
  std::vector<PixelBox> lines;
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const auto [x0, x1] = std::minmax({panel.pixel_x(steps[k - 1].first), panel.pixel_x(steps[k].first)});
    const auto [y0, y1] = std::minmax({panel.pixel_y(steps[k - 1].second), panel.pixel_y(steps[k].second)});
    lines.push_back({x0 - 3, y0 - 3, x1 + 3, y1 + 3});
  }
  for (const ChartMethod& m : chart.methods) {
    const Look look = look_of(m.name);
    const double px = x.at(m.error.median), py = y.at((m.*value).median);
    const std::string style = std::string("lw 1.5 lc rgb '#a0") + (look.color + 1) + "'";  // mostly clear
    if (m.rows > 1) {
      panel.line(x.at(m.error.low), py, x.at(m.error.high), py, style);
      panel.line(px, y.at((m.*value).low), px, y.at((m.*value).high), style);
      const auto box = [&](double x0, double y0, double x1, double y1) {
        lines.push_back(
            {panel.pixel_x(x0) - 1, panel.pixel_y(y0) - 1, panel.pixel_x(x1) + 1, panel.pixel_y(y1) + 1});
      };
      box(x.at(m.error.low), py, x.at(m.error.high), py);
      box(px, y.at((m.*value).low), px, y.at((m.*value).high));
    }
    panel.curve({{px, py}},
                "points pt " + std::to_string(look.mark) + " ps mark lw 1.5 lc rgb '" + look.color + "'");
    anchors.push_back({m.name.substr(0, 40), panel.pixel_x(px), panel.pixel_y(py)});
  }
  const std::vector<PlacedLabel> labels = place_labels(anchors, lines, panel.area());
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::string color = std::string("tc rgb '") + look_of(chart.methods[k].name).color + "'";
    panel.text(labels[k].text, labels[k].x, labels[k].y, "left front " + color);
  }
  panel.end();
}

/// Steps a ray by the angle to the surface; names stand at the right ends.
void draw_steps(Panel panel, const Chart& chart) {
  Extent angles, counts;
  for (const ChartMethod& m : chart.methods)
    for (const auto& [angle, steps] : m.steps) {
      angles.add(std::max(angle, 0.01));
      counts.add(std::max(steps, 0.1));
    }
  Axis x;
  x.title = "angle between rays and surface, degrees";
  x.low = std::log10(angles.low) - 0.05;
  x.high = std::log10(std::max(angles.high, angles.low * 2)) + 0.05;
  for (const double degrees : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 45.0, 90.0})
    if (const double at = std::log10(degrees); at >= x.low && at <= x.high)
      x.ticks.push_back({at, number(degrees)});
  const Axis y = value_axis(counts, "steps a ray", "");
  panel.begin("Steps against angle (" + chart.steps_scene.substr(0, 40) + ")", x, y);
  struct End {
    double pixel;
    const ChartMethod* method;
  };
  std::vector<End> ends;
  for (const ChartMethod& m : chart.methods) {
    if (m.steps.empty()) continue;
    const Look look = look_of(m.name);
    std::vector<std::pair<double, double>> points;
    for (const auto& [angle, steps] : m.steps)
      points.emplace_back(std::log10(std::max(angle, 0.01)), std::log10(std::max(steps, 0.1)));
    panel.curve(points, "linespoints pt " + std::to_string(look.mark) + " ps small_mark lw 1.5 lc rgb '" +
                            look.color + "'");
    ends.push_back({panel.pixel_y(points.back().second), &m});
  }
  // From below upwards each at least a line above the last; then all down again if that went too far.
  std::ranges::sort(ends, {}, &End::pixel);
  constexpr double kLine = 14;
  for (std::size_t k = 1; k < ends.size(); ++k)
    ends[k].pixel = std::max(ends[k].pixel, ends[k - 1].pixel + kLine);
  const double top = panel.area().y1;
  for (std::size_t k = ends.size(); k-- > 0;)
    ends[k].pixel = std::min(ends[k].pixel, k + 1 == ends.size() ? top : ends[k + 1].pixel - kLine);
  for (const End& end : ends)
    panel.text(end.method->name.substr(0, 40), panel.area().x1 + 6, end.pixel,
               std::string("left front tc rgb '") + look_of(end.method->name).color + "'");
  panel.end();
}

double longest_name(const Chart& chart) {
  double width = 0;
  for (const ChartMethod& m : chart.methods)
    if (!m.steps.empty()) width = std::max(width, text_width(m.name.substr(0, 40)));
  return width;
}

}  // namespace

std::string chart_script(const Chart& chart, const ChartPicture& picture) {
  constexpr double kHead = 62, kBig = 380, kSmall = 270, kBelow = 62, kAbove = 34;
  const bool steps = picture.steps && !chart.steps_scene.empty();
  const double big = picture.pareto ? kAbove + kBig + kBelow : 0;
  const double small = picture.memory || steps ? kAbove + kSmall + kBelow : 0;
  const double height = kHead + big + small;
  std::string script = std::string("set terminal ") + (picture.png ? "pngcairo" : "svg") + " size " +
                       number(kWidth) + "," + number(height) + " noenhanced background rgb 'white' font '" +
                       (picture.png ? "DejaVu Sans,9" : "DejaVu Sans,Verdana,sans-serif,11.5") + "'\n";
  // The terminals have units of their own.
  script += picture.png ? "title_font = ',13'\nmark = 1.4\nsmall_mark = 0.8\n"
                        : "title_font = ',16.5'\nmark = 1\nsmall_mark = 0.6\n";
  script += "unset key\nunset tics\nunset border\nset multiplot\n";
  // The head is a plot of nothing.
  const PixelBox page{75, height - kHead, kWidth - 20, height};
  double top = height - kHead;
  Extent speeds, sizes;
  bool several = false;
  for (const ChartMethod& m : chart.methods) {
    for (const double x : {m.speed.low, m.speed.high}) speeds.add(x);
    for (const double x : {m.memory.low, m.memory.high}) sizes.add(x);
    several = several || m.rows > 1;
  }
  script += "set lmargin 0\nset rmargin 0\nset tmargin 0\nset bmargin 0\n";
  const auto head = [&](const std::string& what, double y, const char* style) {
    script += "set label " + gnuplot_text(what) + " at screen " + number(page.x0 / kWidth) + "," +
              number(y / height) + " left " + style + "\n";
  };
  head(chart.subject, height - 22, "font title_font");
  head(std::string(several ? "points: medians, thin lines: ranges; " : "") +
           "grey: what no method beats in both (Pareto front)" +
           (chart.processor.empty() ? "" : "; " + chart.processor),
       height - 42, "tc rgb '#505050'");
  script += std::string("set xrange [0:1]\nset yrange [0:1]\nplot -1\nset border 3 lc rgb '") + kGrey +
            "'\nset tics textcolor rgb '#404040'\nset grid lc rgb '#e8e8e8' lt 1 lw 1\n"
            "set xlabel offset 0,0.2\n";
  if (picture.pareto) {
    const PixelBox area{75, top - kAbove - kBig, kWidth - 20, top - kAbove};
    draw_against_error(Panel(script, area, height), chart, "Speed against error", &ChartMethod::speed,
                       value_axis(speeds, "rays a second", ""), true);
    top -= big;
  }
  const double middle = picture.memory && steps ? kWidth / 2 - 35 : kWidth - 20;
  if (picture.memory) {
    const PixelBox area{75, top - kAbove - kSmall, middle, top - kAbove};
    draw_against_error(Panel(script, area, height), chart, "Memory against error", &ChartMethod::memory,
                       value_axis(sizes, "scene and acceleration data", "B"), false);
  }
  if (steps) {
    const double left = picture.memory ? kWidth / 2 + 50 : 75;
    const double right = kWidth - 16 - std::min(longest_name(chart), 220.0);
    draw_steps(Panel(script, {left, top - kAbove - kSmall, right, top - kAbove}, height), chart);
  }
  script += "unset multiplot\n";
  return script;
}

}  // namespace mesocell
