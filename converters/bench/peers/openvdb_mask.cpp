// First active voxels by OpenVDB's hierarchical differential analyzers. [Museth 2014]
#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>

#include <algorithm>
#include <cmath>

#include "converters/bench/peers/vdb_mask.h"

namespace mesocell {
namespace {

using Ray = openvdb::math::Ray<double>;
using Accessor = openvdb::MaskGrid::ConstAccessor;
using Nodes = openvdb::MaskTree::RootNodeType::NodeChainType;

/// As math::VolumeHDDA, which tells where leaves are, but down to voxels: nodes of a level are stepped over,
/// and entered where there are finer ones.
template <int kLevel>
bool march(Ray& ray, const Accessor& accessor, openvdb::Coord& found) {
  if constexpr (kLevel < 0) {
    openvdb::math::DDA<Ray, 0> dda(ray);
    do {
      if (accessor.isValueOn(dda.voxel())) {
        found = dda.voxel();
        return true;
      }
    } while (dda.step());
    return false;
  } else {
    using Node = typename Nodes::template Get<kLevel>;
    openvdb::math::DDA<Ray, Node::TOTAL> dda(ray);
    do {
      if (accessor.probeConstNode<Node>(dda.voxel())) {
        ray.setTimes(dda.time(), dda.next());
        if (march<kLevel - 1>(ray, accessor, found)) return true;
      } else if (accessor.isValueOn(dda.voxel())) {
        // All of the node is active. By rounding the point may be a hair before it.
        const auto point = ray(dda.time());
        for (int a = 0; a < 3; ++a)
          found[a] =
              std::clamp(int(std::floor(point[a])), dda.voxel()[a], dda.voxel()[a] + int(Node::DIM) - 1);
        return true;
      }
    } while (dda.step());
    return false;
  }
}

class OpenVdbMask final : public MesocellVdbMask {
 public:
  OpenVdbMask(openvdb::MaskGrid::Ptr grid, const std::int32_t (&size)[3]) : grid_(std::move(grid)) {
    std::copy_n(size, 3, size_);
  }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return grid_->memUsage(); }

  void trace(const MesocellVdbRays& rays, MesocellVdbHit* hits) const override {
    const Accessor accessor = grid_->getConstAccessor();
    for (std::uint64_t k = 0; k < rays.count; ++k) {
      VdbRay cut;
      hits[k].found = 0;
      if (!cut.set(rays, k, size_)) continue;
      Ray ray(openvdb::Vec3d(cut.origin), openvdb::Vec3d(cut.direction), cut.t0, cut.t1);
      openvdb::Coord found;
      if (!ray.valid() || !march<2>(ray, accessor, found)) continue;
      hits[k].found = 1;
      for (int a = 0; a < 3; ++a) hits[k].voxel[a] = found[a];
    }
  }

 private:
  openvdb::MaskGrid::Ptr grid_;
  std::int32_t size_[3];
};

}  // namespace

std::unique_ptr<MesocellVdbMask> make_openvdb_mask(openvdb::MaskGrid::Ptr grid,
                                                   const std::int32_t (&size)[3]) {
  return std::make_unique<OpenVdbMask>(std::move(grid), size);
}

}  // namespace mesocell
