#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/surface/explicit_surface.h"

namespace mesocell {

struct GltfOptions {
  bool draco = false;       ///< compress the meshes: KHR_draco_mesh_compression, which readers must know then
  bool cell_colors = true;  ///< of instances: each cell's color, as its material's
  bool no_clobber = false;  ///< an existing file is an error
};

/// Writes a surface in voxels of a grid as GLB, glTF 2.0: positions are whole numbers, which single precision
/// holds; a node's scale and translation make metres of them. Our axes as they are: glTF's +y is our +y.
/// Colors are linear, 16 bits a channel. The same surface gives the same bytes. Draco's coding of positions
/// is exact; normals are rounded to 10 bits each of two octahedral coordinates.
/// The file appears whole or not at all. Errors: kLimit (no triangles, over 2^24 voxels along an axis, over
/// 4 GiB), kOutput, kCancelled.
[[nodiscard]] Status write_gltf(const ExplicitSurface& surface, const GridLayout& grid,
                                const std::string& path, const GltfOptions& options = {},
                                std::uint64_t* file_bytes = nullptr, const Progress* progress = nullptr);

/// The INSIDE instances of a cell: places of their home tiles.
struct CellInstances {
  std::uint32_t cell = 0;  ///< from 1
  std::vector<Index3> homes;
  std::vector<Rgb8> colors;  ///< one a home, or none; written as _COLOR_0, linear, which few readers know
};

/// Writes INSIDE instances by EXT_mesh_gpu_instancing, which readers must know: one mesh a cell, of
/// `surfaces`[cell - 1], see make_cell_surfaces(), and one node a cell with a translation for each instance,
/// in voxels from a tile in the middle of the grid, which single precision holds. A cell's color is its
/// material's. Cells without instances are left out. Errors: kLimit (no instance, over 2^25 voxels along an
/// axis, over 4 GiB), kOutput, kCancelled.
[[nodiscard]] Status write_instanced_gltf(const CellObject& object,
                                          const std::vector<ExplicitSurface>& surfaces,
                                          const std::vector<CellInstances>& instances,
                                          const std::string& path, const GltfOptions& options = {},
                                          std::uint64_t* file_bytes = nullptr,
                                          const Progress* progress = nullptr);

}  // namespace mesocell
