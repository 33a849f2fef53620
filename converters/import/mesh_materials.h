#pragma once

#include <string>
#include <vector>

#include "converters/import/mesh_warning.h"
#include "converters/import/plain_mesh.h"
#include "converters/import/read_notes.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Reads the materials of an OBJ, or the pictures of a PLY, and the pictures that they name: plain files,
/// looked for in the folder of the mesh at `path` by their name there, which may lead out of it; those with
/// a name from the root of a file system are looked for in the folder itself. What is missing or damaged is
/// a warning; `notes` names them all. Kd and pictures multiply; Kd is linear light. Untrusted input: safe.
/// Errors: kCancelled.
[[nodiscard]] Status read_materials(const std::string& path, PlainMesh& mesh,
                                    std::vector<MeshWarning>& warnings, ReadNotes& notes,
                                    const Progress* progress);

/// Colors a mesh of so many triangles by its texture coordinates in a picture, and no more by its materials.
/// Untrusted input: safe. Errors: kUsage (it has none, with what to do), kUnreadable, kInvalidInput, kLimit,
/// kCancelled.
[[nodiscard]] Status use_texture(const std::string& picture, std::uint64_t triangles, SurfacePaint& paint,
                                 const Progress* progress);

}  // namespace mesocell
