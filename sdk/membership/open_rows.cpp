#include "sdk/membership/open_rows.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace mesocell {
namespace {

/// A winding number so near to half-way between whole numbers could as well be on the other side: the voxel
/// is called unsure.
constexpr double kUnsure = 0.1;
/// Far parts are taken ever more strictly, until the sign of |w| - 1/2 is certain.
constexpr double kFirstTolerance = 1e-2, kTolerances[] = {1e-3, 1e-5, 1e-8};
/// What a centre on the boundary or on an edge of a cap is moved by, as if it were by (ε, ε², ε³).
constexpr Vec3 kMove{0x1p-20, 0x1p-30, 0x1p-40};

class Row {
 public:
  Row(const OpenSolid& open, std::span<const Scanline::Event> events, std::uint32_t y, std::uint32_t z,
      std::int32_t mask, std::vector<Interval>& out)
      : open_(open), events_(events), y_(y + 0.5), z_(z + 0.5), mask_(mask), out_(out), first_(out.size()) {}

  /// Up to voxel `end`, where the whole number nearest to the caps' share is known.
  void plain(std::uint32_t end, std::int32_t whole, std::int32_t unsure) {
    while (x_ < end) {
      pass_events();
      const std::uint32_t next = next_ < events_.size() ? std::min(end, events_[next_].x) : end;
      emit(x_, next, closed_ - whole);
      if (solid(closed_ - whole) != solid(closed_ - whole - unsure)) unsure_ += next - x_;
      x_ = next;
    }
  }

  /// Up to voxel `end`, by evaluation. `gradient`: as OpenSolid::Stretch has it.
  void evaluated(std::uint32_t end, double gradient) {
    while (x_ < end) {
      pass_events();
      const WindingField::Value caps = open_.caps({x_ + 0.5, y_, z_}, kFirstTolerance);
      const double winding = closed_ - caps.winding;
      if (!stride(winding, caps.error, gradient, end)) single(winding, caps.error);
    }
  }

  [[nodiscard]] std::uint64_t unsure() const { return unsure_; }

 private:
  /// How far a winding number is from rounding the other way.
  static double margin(double winding) { return 0.5 - std::abs(winding - std::nearbyint(winding)); }

  [[nodiscard]] bool solid(std::int32_t winding) const { return (winding & mask_) != 0; }

  /// Whether a winding number could as well be rounded to what decides otherwise.
  [[nodiscard]] bool unsure(double winding) const {
    const std::int32_t near = std::int32_t(std::nearbyint(winding));
    return margin(winding) < kUnsure && solid(near) != solid(near + (winding > near ? 1 : -1));
  }

  void pass_events() {
    for (; next_ < events_.size() && events_[next_].x <= x_; ++next_) {
      closed_ += events_[next_].delta;
      if (!events_[next_].of_cap) mesh_ += events_[next_].delta;
    }
  }

  void emit(std::uint32_t begin, std::uint32_t end, std::int32_t winding) {
    if (!solid(winding) || begin == end) return;
    if (out_.size() > first_ && out_.back().end == begin)
      out_.back().end = end;
    else
      out_.push_back({begin, end});
  }

  /// Decides several voxels from the first of them: the winding number changes by the surface's crossings,
  /// and else no faster than its gradient.
  bool stride(double winding, double error, double gradient, std::uint32_t end) {
    for (std::uint32_t last = end; last > x_ + 1; last = x_ + (last - x_) / 2) {
      const double reach = error + gradient * (last - x_ - 1);
      if (!(margin(winding) > reach)) continue;
      bool decided = true;
      std::int32_t mesh = 0;
      for (std::size_t k = next_; k < events_.size() && events_[k].x < last && decided; ++k)
        if (!events_[k].of_cap) {
          mesh += events_[k].delta;
          decided = margin(winding + mesh) > reach;
        }
      if (!decided) continue;
      const std::int32_t before = mesh_;
      while (x_ < last) {
        pass_events();
        const std::uint32_t next = next_ < events_.size() ? std::min(last, events_[next_].x) : last;
        const double here = winding + (mesh_ - before);
        if (unsure(here)) unsure_ += next - x_;
        emit(x_, next, std::int32_t(std::nearbyint(here)));
        x_ = next;
      }
      return true;
    }
    return false;
  }

  void single(double winding, double error) {
    const Vec3 centre{x_ + 0.5, y_, z_};
    const auto refine = [&](const WindingField::Value& caps) {
      winding = closed_ - caps.winding;
      error = caps.error;
      return margin(winding) > error;
    };
    if (!(margin(winding) > error) &&
        std::none_of(std::begin(kTolerances), std::end(kTolerances),
                     [&](double tolerance) { return refine(open_.caps(centre, tolerance)); }) &&
        !refine(open_.caps_summed(centre)) && error > kUnsure)
      refine(open_.caps_summed(centre + kMove));
    if (unsure(winding)) ++unsure_;
    // On the half-way surface itself the caps decide, which are exact: so solids that share a plane
    // partition it.
    emit(x_, x_ + 1, margin(winding) > error ? std::int32_t(std::nearbyint(winding)) : closed_);
    ++x_;
  }

  const OpenSolid& open_;
  std::span<const Scanline::Event> events_;
  double y_, z_;
  std::int32_t mask_;
  std::vector<Interval>& out_;
  std::size_t first_, next_ = 0;
  std::uint32_t x_ = 0;
  std::int32_t closed_ = 0, mesh_ = 0;  ///< windings at x_, of all and of the mesh alone
  std::uint64_t unsure_ = 0;
};

}  // namespace

std::uint64_t decide_open_row(const OpenSolid& open, std::span<const Scanline::Event> events, std::uint32_t y,
                              std::uint32_t z, std::uint32_t x_end, std::int32_t mask,
                              std::vector<Interval>& out) {
  Row row(open, events, y, z, mask, out);
  for (const OpenSolid::Stretch& stretch : open.stretches(y, z)) {
    row.plain(stretch.begin, 0, 0);
    if (stretch.evaluate)
      row.evaluated(stretch.end, stretch.gradient);
    else
      row.plain(stretch.end, stretch.whole, stretch.unsure);
  }
  row.plain(x_end, 0, 0);
  return row.unsure();
}

}  // namespace mesocell
