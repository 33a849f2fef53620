#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// The boundary of a mesh as a chain: its edges, each as often as triangles run along it oftener one way than
/// the other, in the direction of the surplus. At each vertex as many end as begin.
/// - `corners`: of triangles, with one vertex for each place, see merge_corners()
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> boundary_chain(std::span<const Triangle> corners);

/// A simple loop of a boundary and triangles that cover it.
struct Cap {
  std::vector<std::uint32_t> loop;  ///< vertices, each once, in the boundary's direction
  std::vector<Triangle> triangles;  ///< whose boundary is the loop run backwards
};

/// Makes a mesh closed in which `chain` is the boundary: the chain is cut into simple loops, and each loop is
/// covered by clipping, again and again, the ear of least area. So narrow cracks are covered by slivers and
/// smooth holes about as a soap film would. Triangles may cross one another and the mesh, and have zero area.
/// No vertex is added.
[[nodiscard]] std::vector<Cap> cap_boundary(std::span<const Vec3> vertices,
                                            std::vector<std::array<std::uint32_t, 2>> chain);

}  // namespace mesocell
