#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/mesh_topology.h"

namespace mesocell {

/// A closed part of a mesh, and the others around it.
struct Shell {
  double volume = 0;                       ///< signed, metres³; summed about the centre of the shell's box
  Vec3 lowest;                             ///< its vertex of the least x, then y, then z
  std::uint32_t containers = 0;            ///< other shells that it is inside
  std::uint32_t container = kNoComponent;  ///< the first of them
  std::int64_t winding = 0;  ///< the sum of their winding numbers about it, each at the first vertex in it
};

/// Volumes of shells and, if `nesting`, which are inside which: shell a is inside shell b if its box is
/// within b's, and each of up to 32 vertices of a, spread over it, is on b or has a winding number of b that
/// is not 0, one of them at least the latter; exactly, about the vertex moved by (ε, ε², ε³). So where shells
/// cross each other neither is inside, but what leans on a wall may be. Of shells with the same box only the
/// later can be inside.
/// - `triangles`: of `vertices`; `shell_of[t]` below `count`, or kNoComponent: not part of a shell
[[nodiscard]] std::vector<Shell> measure_shells(std::span<const Vec3> vertices,
                                                std::span<const Triangle> triangles,
                                                std::span<const std::uint32_t> shell_of, std::uint32_t count,
                                                bool nesting = true);

}  // namespace mesocell
