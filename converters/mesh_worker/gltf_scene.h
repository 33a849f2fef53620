#pragma once

#include <cstddef>
#include <span>

#include "converters/import/painted_mesh.h"
#include "format/result.h"

namespace mesocell {

/// Reads a GLB that normalize_gltf() made by tinygltf: one mesh of all that its scene shows, where its nodes
/// and their instances place it; those that mirror turn its triangles, so that out stays out. Pictures that
/// cannot be decoded are left out, with a warning. Errors: kInvalidInput, kLimit.
[[nodiscard]] Result<WorkerMesh> read_gltf_scene(std::span<const std::byte> glb);

}  // namespace mesocell
