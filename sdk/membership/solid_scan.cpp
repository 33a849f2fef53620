#include "sdk/membership/solid_scan.h"

#include "sdk/membership/cap.h"
#include "sdk/membership/mesh_topology.h"

namespace mesocell {

SolidScan::SolidScan(const TriangleMesh& mesh, const Index3& resolution, const Index3& tiles, SolidRule solid,
                     unsigned threads, const Progress* progress) {
  if (solid == SolidRule::kOuter) outward_ = turn_outward(mesh);
  const TriangleMesh& turned = outward_ ? *outward_ : mesh;
  const std::vector<std::array<std::uint32_t, 2>> chain = boundary_chain(merge_corners(turned));
  boundary_edges_ = chain.size();
  const Index3 size{tiles[0] * resolution[0], tiles[1] * resolution[1], tiles[2] * resolution[2]};
  if (!chain.empty()) open_.emplace(turned, chain, size, threads, progress);
  scanline_.emplace(open_ ? open_->closed() : turned, resolution, tiles, open_ ? &*open_ : nullptr, solid);
}

}  // namespace mesocell
