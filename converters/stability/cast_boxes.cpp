#include "converters/stability/cast_boxes.h"

#include <cassert>
#include <limits>

namespace mesocell {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// The t at which a ray visits a box: from `first` to `last`, where each end belongs to them or not.
struct Span {
  double first = 0, last = kInf;
  bool first_in = true, last_in = false;

  void cut_first(double t, bool in) {
    if (t > first || (t == first && !in)) first_in = in;
    if (t > first) first = t;
  }
  void cut_last(double t, bool in) {
    if (t < last || (t == last && !in)) last_in = in;
    if (t < last) last = t;
  }
  [[nodiscard]] bool empty() const { return !(first < last || (first == last && first_in && last_in)); }
};

}  // namespace

BoxObject make_box_object(const Index3& resolution, std::span<const CellBox> cells, const Index3& tiles,
                          const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t)>& inside) {
  BoxObject made;
  CellObject& o = made.object;
  o.tile.resolution = resolution;
  o.tile.cell_count = std::uint32_t(cells.size());
  o.tile.id_bytes = cells.size() < 256 ? 1 : 2;
  o.tile.voxel_ids.assign(o.tile.voxel_count() * o.tile.id_bytes, 0);
  for (const CellBox& c : cells) {
    assert(c.cell == o.tile.pieces.size() + 1 && c.cell < 65536);
    o.tile.pieces.push_back({std::uint16_t(c.cell), {}});
    for (std::uint32_t z = std::uint32_t(c.low[2]); z < std::uint32_t(c.high[2]); ++z)
      for (std::uint32_t y = std::uint32_t(c.low[1]); y < std::uint32_t(c.high[1]); ++y)
        for (std::uint32_t x = std::uint32_t(c.low[0]); x < std::uint32_t(c.high[0]); ++x) {
          const std::uint64_t i = o.tile.voxel_index(x, y, z) * o.tile.id_bytes;
          o.tile.voxel_ids[i] = std::uint8_t(c.cell);
          if (o.tile.id_bytes == 2) o.tile.voxel_ids[i + 1] = std::uint8_t(c.cell >> 8);
        }
  }
  o.grid = {{0, 0, 0}, 1, tiles};
  o.membership.tiles = tiles;
  o.membership.cell_count = o.tile.cell_count;
  for (std::uint32_t z = 0; z < tiles[2]; ++z)
    for (std::uint32_t y = 0; y < tiles[1]; ++y)
      for (std::uint32_t x = 0; x < tiles[0]; ++x) {
        const bool in = inside(x, y, z);
        o.membership.entries.push_back(std::uint32_t(in ? Tag::kInside : Tag::kOutside));
        if (!in) continue;
        const std::array<std::uint32_t, 3> tile{x, y, z};
        for (CellBox box : cells) {
          for (std::size_t a = 0; a < 3; ++a) {
            box.low[a] += std::int32_t(tile[a] * resolution[a]);
            box.high[a] += std::int32_t(tile[a] * resolution[a]);
          }
          made.boxes.push_back(box);
        }
      }
  return made;
}

std::optional<BoxHit> first_box(std::span<const CellBox> boxes, const Ray& ray) {
  std::optional<BoxHit> best;
  bool best_in = false;
  for (const CellBox& box : boxes) {
    Span span;
    for (std::size_t a = 0; a < 3; ++a) {
      const double o = ray.origin[a], d = ray.direction[a];
      if (d == 0) {
        if (!(o >= box.low[a] && o < box.high[a])) span.last = -1;
        continue;
      }
      const double low = (box.low[a] - o) / d, high = (box.high[a] - o) / d;
      // The lower plane belongs to the box, the upper one does not.
      if (d > 0) {
        span.cut_first(low, true);
        span.cut_last(high, false);
      } else {
        span.cut_first(high, false);
        span.cut_last(low, true);
      }
    }
    // Of boxes met at one t, at a corner, the one that the point is in comes before the one that is entered
    // right after it.
    if (span.empty() || (best && !(span.first < best->t || (span.first == best->t && !best_in)))) continue;
    best = BoxHit{span.first, box.cell};
    best_in = span.first_in;
  }
  return best;
}

}  // namespace mesocell
