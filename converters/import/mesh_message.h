#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "converters/import/painted_mesh.h"
#include "format/result.h"

/// What goes between mesocell_mesh_worker and who runs it. Both are of one build.
namespace mesocell {

inline constexpr const char* kMeshWorker = "mesocell_mesh_worker";

/// The first four bytes of a request.
enum class MeshRequest : std::uint32_t {
  kGltf = 1,   ///< a GLB that normalize_gltf() made; replied by a WorkerMesh
  kDraco = 2,  ///< a .drc file; replied by a WorkerMesh
  kImage = 3,  ///< a PNG, JPEG, BMP or TGA; replied by a TextureImage
};

/// Of all pictures of a mesh together, and along each side of one.
inline constexpr std::uint64_t kMaxTexels = std::uint64_t{1} << 28;
inline constexpr std::uint32_t kMaxTextureSide = 1u << 15;

[[nodiscard]] std::vector<std::byte> write_mesh_message(const WorkerMesh& mesh);
[[nodiscard]] std::vector<std::byte> write_image_message(const TextureImage& image);

/// Parse what a worker replied. Untrusted input: safe; counts are compared with the bytes that are there
/// before memory is taken, indices are in range, numbers finite, arrays as long as they must be. Errors:
/// kInvalidInput.
[[nodiscard]] Result<WorkerMesh> read_mesh_message(std::span<const std::byte> bytes);
[[nodiscard]] Result<TextureImage> read_image_message(std::span<const std::byte> bytes);

}  // namespace mesocell
