#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

struct SelfIntersectionLimits {
  std::uint64_t max_pairs = 10'000;         ///< found
  std::uint64_t max_tests = 1'000'000'000;  ///< pairs of triangles whose boxes meet
};

struct SelfIntersections {
  std::uint64_t pairs = 0;      ///< at most max_pairs
  bool at_least = false;        ///< a limit was met, or the search was cancelled: there may be more
  std::optional<Vec3> example;  ///< the centre of what the boxes of one such pair have in common
};

/// Pairs of triangles that have more in common than their vertices at the same places and the edges between
/// them; exactly, see triangles_intersect(). Triangles of area zero are left out, and so are pairs with all
/// three vertices in common. The result does not depend on the number of threads.
/// - `threads`: 0 for the machine's
[[nodiscard]] SelfIntersections find_self_intersections(std::span<const Vec3> vertices,
                                                        std::span<const Triangle> triangles,
                                                        const SelfIntersectionLimits& limits = {},
                                                        unsigned threads = 0,
                                                        const Progress* progress = nullptr);

}  // namespace mesocell
