#include "sdk/membership/open_rows.h"

#include <algorithm>
#include <cmath>

namespace mesocell {
namespace {

/// Voxels that are tried to be decided at once.
constexpr std::uint32_t kStrides[] = {64, 16, 4};
/// A winding number so near to 1/2 or -1/2 could as well be on the other side: the voxel is called unsure.
constexpr double kUnsure = 0.1;

class Row {
 public:
  Row(const OpenSolid& open, std::span<const Scanline::Event> events, std::uint32_t y, std::uint32_t z,
      std::vector<Interval>& out)
      : open_(open), events_(events), y_(y + 0.5), z_(z + 0.5), out_(out), first_(out.size()) {}

  /// Up to voxel `end`, where the nearest whole number is that of the closed mesh.
  void plain(std::uint32_t end) {
    while (x_ < end) {
      pass_events();
      const std::uint32_t next = next_ < events_.size() ? std::min(end, events_[next_].x) : end;
      emit(x_, next, closed_ != 0);
      x_ = next;
    }
  }

  /// Up to voxel `end`, by evaluation.
  void evaluated(std::uint32_t end) {
    while (x_ < end) {
      pass_events();
      const WindingField::Value cones = open_.cones({x_ + 0.5, y_, z_});
      const double winding = closed_ - cones.winding;
      if (!stride(winding, cones.error, end)) single(winding, cones.error);
    }
  }

  [[nodiscard]] std::uint64_t unsure() const { return unsure_; }

 private:
  static double margin(double winding) { return std::abs(std::abs(winding) - 0.5); }

  void pass_events() {
    for (; next_ < events_.size() && events_[next_].x <= x_; ++next_) {
      closed_ += events_[next_].delta;
      if (!events_[next_].of_cone) mesh_ += events_[next_].delta;
    }
  }

  void emit(std::uint32_t begin, std::uint32_t end, bool inside) {
    if (!inside || begin == end) return;
    if (out_.size() > first_ && out_.back().end == begin)
      out_.back().end = end;
    else
      out_.push_back({begin, end});
  }

  /// Decides several voxels from the first of them: the winding number changes by the surface's crossings,
  /// and else no faster than its gradient.
  bool stride(double winding, double error, std::uint32_t end) {
    for (const std::uint32_t most : kStrides) {
      const std::uint32_t last = std::min(end, x_ + most);
      if (last - x_ < 2) continue;
      const double reach =
          error + open_.gradient({{x_ + 0.5, y_, z_}, {last - 0.5, y_, z_}}) * (last - x_ - 1);
      if (!(margin(winding) > reach)) continue;
      bool decided = true;
      std::int32_t mesh = 0;
      for (std::size_t k = next_; k < events_.size() && events_[k].x < last && decided; ++k)
        if (!events_[k].of_cone) {
          mesh += events_[k].delta;
          decided = margin(winding + mesh) > reach;
        }
      if (!decided) continue;
      const std::int32_t before = mesh_;
      while (x_ < last) {
        pass_events();
        const std::uint32_t next = next_ < events_.size() ? std::min(last, events_[next_].x) : last;
        const double here = winding + (mesh_ - before);
        if (margin(here) < kUnsure) unsure_ += next - x_;
        emit(x_, next, std::abs(here) > 0.5);
        x_ = next;
      }
      return true;
    }
    return false;
  }

  void single(double winding, double error) {
    if (!(margin(winding) > error)) {
      const WindingField::Value cones = open_.cones_summed({x_ + 0.5, y_, z_});
      winding = closed_ - cones.winding;
      error = cones.error;
    }
    if (margin(winding) < kUnsure) ++unsure_;
    // On the half-way surface itself the cones decide, which are exact: so solids that share a plane
    // partition it.
    emit(x_, x_ + 1, margin(winding) > error ? std::abs(winding) > 0.5 : closed_ != 0);
    ++x_;
  }

  const OpenSolid& open_;
  std::span<const Scanline::Event> events_;
  double y_, z_;
  std::vector<Interval>& out_;
  std::size_t first_, next_ = 0;
  std::uint32_t x_ = 0;
  std::int32_t closed_ = 0, mesh_ = 0;  ///< windings at x_, of all and of the mesh alone
  std::uint64_t unsure_ = 0;
};

}  // namespace

std::uint64_t decide_open_row(const OpenSolid& open, std::span<const Scanline::Event> events, std::uint32_t y,
                              std::uint32_t z, std::uint32_t x_end, std::span<const RowStretch> stretches,
                              std::vector<Interval>& out) {
  Row row(open, events, y, z, out);
  for (const RowStretch& stretch : stretches) {
    if (stretch.begin >= x_end) break;
    row.plain(stretch.begin);
    row.evaluated(std::min(stretch.end, x_end));
  }
  row.plain(x_end);
  return row.unsure();
}

}  // namespace mesocell
