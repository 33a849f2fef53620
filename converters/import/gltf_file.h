#pragma once

#include <span>
#include <string>
#include <vector>

#include "converters/import/painted_mesh.h"
#include "converters/import/read_notes.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Reads a glTF 2.0, as JSON or GLB, in mesocell_mesh_worker. `bytes`: of the file at `path`, in whose folder
/// and below its other files are looked for, none larger than `max_file_bytes`; `notes` tells of them.
/// Untrusted input: safe. Errors: kInvalidInput, kUnreadable, kLimit, kCancelled, kOutput (the worker is not
/// there).
[[nodiscard]] Result<WorkerMesh> read_gltf(std::span<const std::byte> bytes, const std::string& path,
                                           std::uint64_t max_file_bytes, ReadNotes& notes,
                                           const Progress* progress);

/// Reads a mesh compressed by Draco, likewise.
[[nodiscard]] Result<WorkerMesh> read_draco(std::span<const std::byte> bytes, const Progress* progress);

/// Decodes a PNG, JPEG, BMP or TGA, likewise.
[[nodiscard]] Result<TextureImage> decode_texture(std::span<const std::byte> bytes, const Progress* progress);

}  // namespace mesocell
