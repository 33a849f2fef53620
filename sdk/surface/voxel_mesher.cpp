#include "sdk/surface/voxel_mesher.h"

namespace mesocell {

VertexFans PaddedVoxels::fans(const LatticePoint& v) const {
  const FanTable& table = fan_table();
  const std::uint8_t here = configuration(v);
  std::uint8_t turned = 0;
  for (unsigned edge = 0; table.doubled[here] >> edge; ++edge) {
    if (!(table.doubled[here] >> edge & 1)) continue;
    LatticePoint other = v;
    other[edge / 2] += edge % 2 ? 1 : -1;
    if (table.doubled[configuration(other)] >> (edge ^ 1) & 1) turned = std::uint8_t(turned | 1u << edge);
  }
  return turned ? find_fans(here, turned) : table.fans[here];
}

}  // namespace mesocell
