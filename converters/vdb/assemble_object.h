#pragma once

#include "converters/vdb/object_metadata.h"
#include "converters/vdb/sparse_volume.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Restores an asset from its grids, as export_vdb() writes labels. Untrusted input: safe; whatever the grids
/// say, what is returned is a sound object, or they are refused. Errors: kInvalidInput (the grids contradict
/// each other), kLimit (a tile of more than 2^28 voxels), kCancelled.
/// - `tile`: of whole numbers, with the metadata; `home`: of three; `membership`: of whole numbers
[[nodiscard]] Result<CellObject> assemble_object(const SparseVolume& tile, const SparseVolume& home,
                                                 const SparseVolume& membership, unsigned threads = 0,
                                                 const Progress* progress = nullptr);

}  // namespace mesocell
