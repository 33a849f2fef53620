#include "format/cell_object.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace mesocell {

const Rgb8* SurfaceColors::find(std::uint64_t tile, std::size_t v) const {
  const std::uint32_t brick = entries[static_cast<std::size_t>(tile)];
  if (brick == kNoBrick) return nullptr;
  const std::uint8_t* mask = masks.data() + brick * mask_bytes();
  if ((mask[v / 8] >> (v % 8) & 1) == 0) return nullptr;
  std::size_t before = first[brick];
  for (const std::uint8_t* const end = mask + v / 8; mask < end;) {
    std::uint64_t eight = 0;
    const auto n = std::min<std::size_t>(8, static_cast<std::size_t>(end - mask));
    std::memcpy(&eight, mask, n);
    before += static_cast<std::size_t>(std::popcount(eight));
    mask += n;
  }
  const unsigned below = (1u << v % 8) - 1;
  before += static_cast<std::size_t>(std::popcount(masks[brick * mask_bytes() + v / 8] & below));
  return &colors[before];
}

InstanceCounts count_instances(const MembershipMap& membership) {
  InstanceCounts counts;
  std::uint64_t mixed = 0;
  for (const std::uint32_t entry : membership.entries) {
    switch (entry) {
      case 0:
        counts.outside += membership.cell_count;
        break;
      case 1:
        counts.inside += membership.cell_count;
        break;
      case 2:
        counts.intersected += membership.cell_count;
        break;
      default:
        ++mixed;
        break;
    }
  }
  // Unused bits are zero and would count as outside, so outside is what remains.
  std::uint64_t inside = 0, intersected = 0;
  for (const std::uint8_t b : membership.blocks) {
    inside += static_cast<unsigned>(std::popcount(b & 0x55u));
    intersected += static_cast<unsigned>(std::popcount(b & 0xaau));
  }
  counts.inside += inside;
  counts.intersected += intersected;
  counts.outside += mixed * membership.cell_count - inside - intersected;
  return counts;
}

std::uint64_t count_inside_voxels(const CellObject& object) {
  std::vector<std::uint64_t> voxels(object.tile.cell_count + 1);
  std::uint64_t of_tile = 0;
  for (std::uint64_t i = 0; i < object.tile.voxel_count(); ++i)
    if (const std::uint32_t id = object.tile.id(i)) {
      ++voxels[object.tile.pieces[id - 1].cell];
      ++of_tile;
    }
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t < object.membership.entries.size(); ++t) {
    const std::uint32_t entry = object.membership.entries[t];
    if (entry < MembershipMap::kFirstBlock) {
      if (entry == std::uint32_t(Tag::kInside)) sum += of_tile;
      continue;
    }
    for (std::uint32_t c = 1; c <= object.tile.cell_count; ++c)
      if (object.membership.tag(t, c) == Tag::kInside) sum += voxels[c];
  }
  return sum;
}

double inside_volume(const CellObject& object) {
  const double edge = object.grid.voxel_edge;
  return double(count_inside_voxels(object)) * (edge * edge * edge);
}

}  // namespace mesocell
