#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// The object with its tile at half the resolution, `level` times: each voxel is of the piece that most of
/// its 2^level voxels a side are of, the one of the least id where several are; tags and colors stay as they
/// are, so an instance is INSIDE as it was. Nothing if the resolution is not divisible so often, or would be
/// below 4.
[[nodiscard]] std::optional<CellObject> coarser(const CellObject& object, unsigned level);

/// Level of detail: exact tracing of the coarsest level of the tile whose voxels appear at most `pixels`
/// pixels large where the ray can first meet something. What lies farther on the ray is seen at the same
/// level, so it appears smaller still.
///
/// In first_hits() a pixel is the angle between neighbours of 64 rays that begin at one point, a square of 8
/// × 8 pixels; other rays, and single ones, take kLodPixel. Rays that begin in the object's box see the
/// finest level. Elements of hits are voxels of the level that a hit tells. first_exit() and inside() are of
/// the finest. `pixels` > 0 (assert).
[[nodiscard]] std::unique_ptr<Caster> make_lod_caster(const CellObject& object, double pixels);

/// The pixel of a ray that comes alone, radians: that of a picture 1000 pixels high that is seen at 53
/// degrees.
inline constexpr double kLodPixel = 1e-3;

}  // namespace mesocell
