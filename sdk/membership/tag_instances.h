#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/vec.h"
#include "sdk/membership/membership.h"
#include "sdk/membership/scanline.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// Who says what is inside, a bundle of rows at a time: those of the tiles (·, ty, tz). Thread safety: const.
class RowSource {
 public:
  virtual ~RowSource() = default;
  /// As Scanline::bundle().
  virtual void bundle(std::uint32_t ty, std::uint32_t tz, Scanline::Scratch& scratch,
                      RowIntervals& out) const = 0;
  /// Calls `visit` for each triangle of the surface that may touch those tiles, voxel units; for rule
  /// kConservative.
  virtual void triangles(std::uint32_t ty, std::uint32_t tz,
                         const std::function<void(const std::array<Vec3, 3>&)>& visit) const = 0;
};

/// Tags every cell instance by what is inside of it. Of the report it adds inside_voxels, mixed_tiles and
/// unsure_voxels. Errors: kLimit, kCancelled.
[[nodiscard]] Result<MembershipMap> tag_instances(const RowSource& source, const Index3& tiles,
                                                  const TileMap& tile, const MembershipOptions& options,
                                                  MembershipReport& report, const Progress* progress);

}  // namespace mesocell
