#include "sdk/membership/open_rows.h"

#include <algorithm>

namespace mesocell {
namespace {

class Row {
 public:
  Row(std::span<const Scanline::Crossing> crossings, std::int32_t mask, std::vector<Interval>& out)
      : crossings_(crossings), mask_(mask), out_(out), first_(out.size()) {}

  /// Up to voxel `end`, where the whole number nearest to the caps' share is known.
  void advance(std::uint32_t end, std::int32_t whole, std::int32_t unsure) {
    while (x_ < end) {
      pass_crossings();
      const std::uint32_t next = next_ < crossings_.size() ? std::min(end, crossings_[next_].x()) : end;
      emit(x_, next, closed_ - whole);
      if (solid(closed_ - whole) != solid(closed_ - whole - unsure)) unsure_ += next - x_;
      x_ = next;
    }
  }

  [[nodiscard]] std::uint64_t unsure() const { return unsure_; }

 private:
  [[nodiscard]] bool solid(std::int32_t winding) const { return (winding & mask_) != 0; }

  void pass_crossings() {
    for (; next_ < crossings_.size() && crossings_[next_].x() <= x_; ++next_)
      closed_ += crossings_[next_].delta();
  }

  void emit(std::uint32_t begin, std::uint32_t end, std::int32_t winding) {
    if (!solid(winding) || begin == end) return;
    if (out_.size() > first_ && out_.back().end == begin)
      out_.back().end = end;
    else
      out_.push_back({begin, end});
  }

  std::span<const Scanline::Crossing> crossings_;
  std::int32_t mask_;
  std::vector<Interval>& out_;
  std::size_t first_, next_ = 0;
  std::uint32_t x_ = 0;
  std::int32_t closed_ = 0;  ///< winding number of the closed mesh at x_
  std::uint64_t unsure_ = 0;
};

}  // namespace

std::uint64_t decide_open_row(const OpenSolid& open, std::span<const Scanline::Crossing> crossings,
                              std::uint32_t y, std::uint32_t z, std::uint32_t x_end, std::int32_t mask,
                              std::vector<Interval>& out) {
  Row row(crossings, mask, out);
  open.for_stretches(y, z, [&](const OpenSolid::Stretch& stretch) {
    row.advance(stretch.begin, 0, 0);
    row.advance(stretch.end, stretch.whole, stretch.unsure);
  });
  row.advance(x_end, 0, 0);
  return row.unsure();
}

}  // namespace mesocell
