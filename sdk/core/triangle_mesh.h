#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/core/vec.h"

namespace mesocell {

/// Indices of a triangle's vertices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// An indexed triangle soup, metres. Nothing is assumed of its topology; indices are below vertices.size()
/// and coordinates are finite, which whoever makes a mesh from untrusted data has checked.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

/// The box of the vertices that triangles use; empty if there are no triangles.
[[nodiscard]] Box3 bounding_box(const TriangleMesh& mesh);

/// Signed volume, metres³: positive if a closed mesh is oriented outward. Summed about the box's centre.
[[nodiscard]] double signed_volume(const TriangleMesh& mesh);

/// For every vertex the first of those at the same place, which stands for them all.
[[nodiscard]] std::vector<std::uint32_t> merge_identical_vertices(const std::vector<Vec3>& vertices);

}  // namespace mesocell
