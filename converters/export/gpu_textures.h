#pragma once

#include <cstdint>
#include <string>

#include "format/cell_object.h"
#include "format/result.h"

namespace mesocell {

/// Writes the maps of a cell object as textures for a GPU, as the source lays them out: beside `path`, a JSON
/// file that says what is where, raw files of the same stem:
/// - STEM.tile.r8: a byte a voxel, the split cell, 0 where empty; x fastest
/// - STEM.membership.rgba32ui: four little-endian uint32 a tile, two bits a split cell: 0 outside, 1 inside,
///   2 intersected, 3 the tile has none
/// - STEM.color.rgba8: sRGB and 255, a color voxel each, if the object has a solid texture
/// The JSON is written last; without it there are no textures. Errors: kUsage, kLimit (more than 64 split
/// cells), kOutput. `bytes`: of all files. [Nürnberg 2011, 4.2-4.4; sdk/trace/gpu_maps.h]
[[nodiscard]] Status write_gpu_textures(const CellObject& object, const std::string& path,
                                        bool no_clobber = false, std::uint64_t* bytes = nullptr);

}  // namespace mesocell
