#include "format/cell_object.h"

#include <bit>

namespace mesocell {

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

}  // namespace mesocell
