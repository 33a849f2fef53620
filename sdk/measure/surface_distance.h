#pragma once

#include <cstdint>
#include <functional>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

/// Distances of the samples of one surface from another, metres.
struct DistanceFigures {
  double max = 0, mean = 0, rms = 0;
  std::uint64_t samples = 0;
};

/// The representation error of an asset: how far its surface and that of a mesh are from each other.
struct SurfaceDistance {
  DistanceFigures asset_to_mesh;  ///< from what can be seen of the asset to the mesh's surface
  DistanceFigures mesh_to_asset;  ///< from the mesh's surface to what is inside the asset
  double diagonal = 0;            ///< of the mesh's bounding box, metres
  std::uint64_t seed = 0;

  /// A distance in per cent of the diagonal.
  [[nodiscard]] double percent(double distance) const { return 100 * distance / diagonal; }
};

struct SurfaceDistanceOptions {
  std::uint64_t samples = 100'000;  ///< in each direction, at least 1
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: the machine's; the result does not depend on it
};

/// Samples both surfaces, as Metro does [Cignoni, Rocchini, Scopigno 1998]. The asset's: where random lines
/// through its bounding sphere, uniform in direction and place, first meet it from either end, so walls and
/// gaps that cannot be seen from outside do not count; the distance is that of the mesh's closest point. The
/// mesh's: points uniform by area; the distance is that of the asset's closest part, 0 inside. An asset that
/// a thousand lines a sample do not hit often enough gets fewer samples.
/// - `exact`: the asset by exact tracing
/// - `distance`: distance of a point, metres, from what is inside the asset, 0 there; called from many
/// threads
/// - `mesh`: any soup; it need not be closed
/// Errors: kInvalidInput (the mesh has no area, or reaches 2^40 times the asset's smallest detail beyond it;
/// no line hits the asset), kCancelled.
[[nodiscard]] Result<SurfaceDistance> measure_surface_distance(const Caster& exact,
                                                               const std::function<double(Vec3)>& distance,
                                                               const TriangleMesh& mesh,
                                                               const SurfaceDistanceOptions& options = {},
                                                               const Progress* progress = nullptr);

/// The same of a cell object. Errors also: those of NearestCell::make().
[[nodiscard]] Result<SurfaceDistance> measure_surface_distance(const CellObject& object,
                                                               const TriangleMesh& mesh,
                                                               const SurfaceDistanceOptions& options = {},
                                                               const Progress* progress = nullptr);

}  // namespace mesocell
