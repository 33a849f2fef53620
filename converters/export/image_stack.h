#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// A map of a cell object that is a stack of pictures, a voxel a pixel: the slices are z from below, columns
/// x from the left, rows y from the bottom, as volumes are read.
enum class StackMap : std::uint8_t {
  kCells,    ///< of the tile: the cell of each voxel, 0 where empty; 8 bits, 16 from 256 cells on
  kColors,   ///< of the tile: 8-bit sRGB
  kNormals,  ///< of the tile's boundary voxels: x, y, z as floats, 0 elsewhere; 8 bits: 128 + 127 n, 0
             ///< elsewhere
};

struct StackExportReport {
  std::uint32_t slices = 0;
  std::uint64_t bytes = 0;
  std::vector<std::string> losses;
};

/// Writes a stack: a path that ends with "/" or is a folder's is filled with pictures 0000.png, 0001.png, …,
/// which for normals are .exr; .tif is one of several pages, .exr one of several parts, of floats. Errors:
/// kUsage (the object has no such map; not one of these paths), kOutput, kLimit, kCancelled.
[[nodiscard]] Status write_image_stack(const CellObject& object, StackMap map, const std::string& path,
                                       bool no_clobber = false, StackExportReport* report = nullptr,
                                       const Progress* progress = nullptr);

}  // namespace mesocell
