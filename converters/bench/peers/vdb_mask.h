#pragma once

#include <openvdb/openvdb.h>

#include <memory>

#include "converters/bench/peers/vdb_module.h"

/// Voxels as a library of the module holds them.
struct MesocellVdbMask {
  virtual ~MesocellVdbMask() = default;
  [[nodiscard]] virtual std::uint64_t memory_bytes() const = 0;
  virtual void trace(const MesocellVdbRays& rays, MesocellVdbHit* hits) const = 0;
};

namespace mesocell {

/// A ray of the input in voxels, cut to a box.
struct VdbRay {
  double origin[3], direction[3];
  double t0 = 0, t1 = 0;

  /// False if the ray misses the box from 0 to `size`.
  bool set(const MesocellVdbRays& rays, std::uint64_t k, const std::int32_t (&size)[3]);
};

[[nodiscard]] std::unique_ptr<MesocellVdbMask> make_openvdb_mask(openvdb::MaskGrid::Ptr grid,
                                                                 const std::int32_t (&size)[3]);
[[nodiscard]] std::unique_ptr<MesocellVdbMask> make_nanovdb_mask(const openvdb::MaskGrid::Ptr& grid,
                                                                 const std::int32_t (&size)[3]);

}  // namespace mesocell
