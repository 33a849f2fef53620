#include "sdk/membership/shape_rows.h"

#include <algorithm>

namespace mesocell {

Vec3 ShapeRows::centre(const Index3& voxel) const {
  Vec3 p;
  for (std::size_t a = 0; a < 3; ++a) p[a] = grid_.box_min[a] + (double(voxel[a]) + 0.5) * grid_.voxel_edge;
  return p;
}

void ShapeRows::split(const Block& block, const Index3& first,
                      std::vector<std::vector<Interval>>& rows) const {
  std::size_t longest = 0;
  Index3 size{};
  for (std::size_t a = 0; a < 3; ++a) {
    size[a] = block.high[a] - block.low[a];
    if (size[a] > size[longest]) longest = a;
  }
  BoxSide side = BoxSide::kMixed;
  if (size[longest] == 1) {
    side = shape_.inside(centre(block.low)) ? BoxSide::kInside : BoxSide::kOutside;
  } else {
    Box3 box;
    box.add(centre(block.low));
    box.add(centre({block.high[0] - 1, block.high[1] - 1, block.high[2] - 1}));
    side = shape_.side(box);
  }
  if (side == BoxSide::kOutside) return;
  if (side == BoxSide::kInside) {
    for (std::uint32_t z = block.low[2]; z < block.high[2]; ++z)
      for (std::uint32_t y = block.low[1]; y < block.high[1]; ++y) {
        std::vector<Interval>& row = rows[y - first[1] + std::size_t{resolution_[1]} * (z - first[2])];
        // Blocks come in the order of x in each row, as halves do.
        if (!row.empty() && row.back().end == block.low[0])
          row.back().end = block.high[0];
        else
          row.push_back({block.low[0], block.high[0]});
      }
    return;
  }
  Block low = block, high = block;
  low.high[longest] = high.low[longest] = block.low[longest] + size[longest] / 2;
  split(low, first, rows);
  split(high, first, rows);
}

void ShapeRows::bundle(std::uint32_t ty, std::uint32_t tz, Scanline::Scratch&, RowIntervals& out) const {
  const Index3 first{0, ty * resolution_[1], tz * resolution_[2]};
  std::vector<std::vector<Interval>> rows(std::size_t{resolution_[1]} * resolution_[2]);
  // A tile at a time, so that blocks are about as long as wide.
  for (std::uint32_t t = 0; t < grid_.tiles[0]; ++t)
    split({{t * resolution_[0], first[1], first[2]},
           {(t + 1) * resolution_[0], first[1] + resolution_[1], first[2] + resolution_[2]}},
          first, rows);
  out.first.assign(1, 0);
  out.intervals.clear();
  for (const std::vector<Interval>& row : rows) {
    out.intervals.insert(out.intervals.end(), row.begin(), row.end());
    out.first.push_back(std::uint32_t(out.intervals.size()));
  }
}

}  // namespace mesocell
