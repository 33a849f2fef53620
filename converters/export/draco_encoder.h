#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "format/result.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// A mesh for Draco.
struct DracoInput {
  std::uint32_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
  std::function<std::array<float, 3>(std::uint32_t)> position;
  std::function<Triangle(std::uint64_t)> triangle;
  std::span<const std::array<float, 3>> normals;         ///< one a vertex, or none
  std::span<const std::array<std::uint16_t, 4>> colors;  ///< one a vertex, or none; kept as they are
  /// Positions are rounded to the points origin + k · range / (2^bits - 1), k = 0 … 2^bits - 1, on each axis.
  int position_bits = 16;  ///< 1…30
  std::array<float, 3> origin{};
  float range = 1;
  bool keep_order = false;  ///< of vertices and triangles, which takes more bytes
};

/// Unique ids of attributes in the bitstream.
enum DracoAttribute : std::uint32_t { kDracoPosition = 0, kDracoNormal = 1, kDracoColor = 2 };

struct DracoMesh {
  std::vector<std::byte> bytes;               ///< a Draco bitstream
  std::uint64_t vertices = 0, triangles = 0;  ///< as decoders find them
};

/// Compresses a mesh. Memory is some 200 bytes a triangle. Errors: kLimit (more than 2^31 - 1 vertices or
/// triangles; out of memory), kInvalidInput (Draco refuses the mesh).
[[nodiscard]] Result<DracoMesh> encode_draco(const DracoInput& input);

}  // namespace mesocell
