#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/surface/explicit_surface.h"

namespace mesocell {

/// What a cell object becomes in a .vdb file; several kinds can be in one.
struct VdbKinds {
  /// Grid `surface`: signed distances to the surface of the solid of all INSIDE voxels, exact at the samples
  /// but for rounding to float, within 3 voxels of it; metres, negative inside. Samples are at the centres of
  /// voxels; where the surface has an edge or a corner, interpolation between them rounds it.
  bool level_set = false;
  /// Grid `density`: 1 in INSIDE voxels, 0 elsewhere.
  bool fog = false;
  /// What an asset is made of, so that read_vdb_object() restores it: grids `cell` (in INSIDE voxels, the
  /// cell), `membership` (1 in voxels of INSIDE instances, 2 of INTERSECTED ones), and of one tile, from
  /// (0,0,0) on, `tile` (the cell of each voxel) and `tile_home` (of each voxel, Piece::home). 0 elsewhere.
  bool labels = false;
  /// Grid `Cd`: in INSIDE voxels the color at their centre, linear light; 0 elsewhere.
  bool colors = false;
};

struct VdbExportOptions {
  VdbKinds kinds = {};
  std::optional<TileBox> tiles = std::nullopt;  ///< all if not set; what is beyond counts as empty. Not with labels
  std::uint64_t max_voxels = std::uint64_t{1} << 27;  ///< in leaves, of each grid
  bool no_clobber = false;
  unsigned threads = 0;  ///< 0: the machine's; the file does not depend on it
};

struct VdbExportReport {
  struct Grid {
    std::string name;
    std::uint64_t voxels = 0;  ///< in leaves
  };
  std::vector<Grid> grids;
  std::uint64_t bytes = 0;
  std::vector<std::string> losses;  ///< what the file does not keep
};

/// Writes a cell object as OpenVDB grids; sample (i, j, k) is the centre of voxel (i, j, k) of the grid,
/// metres. The same object and options give the same bytes. Distances are computed here, exactly, by a
/// separable minimum over the voxels around. [Saito and Toriwaki 1994] Errors: kUsage (no kind, a range
/// beyond the grid, labels of a range), kInvalidInput (nothing to write), kLimit (more voxels than allowed,
/// with an estimate), kOutput, kCancelled.
[[nodiscard]] Status export_vdb(const CellObject& object, const std::string& path,
                                const VdbExportOptions& options, VdbExportReport* report = nullptr,
                                const Progress* progress = nullptr);

}  // namespace mesocell
