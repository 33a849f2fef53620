#include "sdk/surface/inside_tiles.h"

#include <algorithm>
#include <cassert>

namespace mesocell {
namespace {

LatticePoint beside(LatticePoint t, std::size_t axis, int step) {
  t[axis] += step;
  return t;
}

}  // namespace

InsideTiles::InsideTiles(const CellObject& object, const TileBox& box)
    : tile_(object.tile), tiles_(object.grid.tiles), box_(box), pieces_(object.tile, object.membership) {
  for (std::size_t a = 0; a < 3; ++a) assert(box.begin[a] < box.end[a] && box.end[a] <= tiles_[a]);
  const std::uint64_t count = tile_.voxel_count();
  for (std::uint64_t i = 0; i < count && solid_; ++i) solid_ = tile_.id(i) != 0;
}

std::uint64_t InsideTiles::count_own_faces(const TileContacts& contacts, const LatticePoint& t) const {
  const std::uint32_t own = entry(t);
  if (own == InsidePieces::kNone) return 0;
  std::uint64_t faces = 0;
  if (!full(own))
    for (const TileContacts::Contact& c : contacts.within())
      if (has(own, c.lower) != has(own, c.upper)) faces += c.faces;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t next = entry(beside(t, axis, 1)), last = entry(beside(t, axis, -1));
    if (full(own) && full(next) && full(last)) continue;
    for (const TileContacts::Contact& c : contacts.across(axis)) {
      if (has(own, c.lower) && !has(next, c.upper)) faces += c.faces;
      if (has(own, c.upper) && !has(last, c.lower)) faces += c.faces;
    }
  }
  return faces;
}

void InsideTiles::fill(const LatticePoint& t, PaddedVoxels& voxels) const {
  constexpr std::int32_t kPad = PaddedVoxels::kPad;
  LatticePoint r{};
  for (std::size_t a = 0; a < 3; ++a) r[a] = std::int32_t(tile_.resolution[a]);
  voxels.reset(r);
  // Tiles have at least four voxels along an axis, so what is around one is of those that touch it.
  const auto side = [](std::int32_t x, std::int32_t size) { return x < 0 ? -1 : x >= size ? 1 : 0; };
  LatticePoint v{};
  for (v[2] = -kPad; v[2] < r[2] + kPad; ++v[2])
    for (v[1] = -kPad; v[1] < r[1] + kPad; ++v[1]) {
      const std::int32_t dz = side(v[2], r[2]), dy = side(v[1], r[1]);
      const std::uint64_t row =
          tile_.voxel_index(0, std::uint32_t(v[1] - dy * r[1]), std::uint32_t(v[2] - dz * r[2]));
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        const std::uint32_t set = entry({t[0] + dx, t[1] + dy, t[2] + dz});
        if (set == InsidePieces::kNone) continue;
        const std::int32_t from = dx < 0 ? -kPad : dx > 0 ? r[0] : 0;
        const std::int32_t count = dx == 0 ? r[0] : kPad;
        std::uint8_t* const out = &voxels.at({from, v[1], v[2]});
        if (full(set)) {
          std::fill(out, out + count, std::uint8_t{1});
          continue;
        }
        const std::uint64_t first = row + std::uint64_t(from - dx * r[0]);
        for (std::int32_t x = 0; x < count; ++x)
          out[x] = pieces_.has(set, tile_.id(first + std::uint64_t(x)));
      }
    }
}

}  // namespace mesocell
