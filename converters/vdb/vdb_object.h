#pragma once

#include <cstdint>
#include <string>

#include "converters/vdb/vdb_file.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Whether a .vdb file has the grids of an asset, as export_vdb() writes labels, by its head.
[[nodiscard]] bool is_vdb_object(const std::string& path);

/// Restores the asset that export_vdb() wrote as labels: grid, tile and tags are equal to what was written.
/// Colors, normals and metadata are not in the file. Untrusted input: safe; whatever the grids say, what is
/// returned is a sound object, or they are refused. Errors: those of read_vdb(), kInvalidInput (the grids
/// contradict each other), kLimit (a tile of more than 2^28 voxels), kCancelled.
[[nodiscard]] Result<CellObject> read_vdb_object(const std::string& path, const VdbReadOptions& options = {},
                                                 unsigned threads = 0, const Progress* progress = nullptr);

}  // namespace mesocell
