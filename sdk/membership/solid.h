#pragma once

#include <cstdint>

#include "format/api.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell MESOCELL_API {

/// What of a mesh is solid, by its winding number w, the nearest whole number to it if the mesh is open.
/// [spec 4.3.1]
enum class SolidRule : std::uint8_t {
  kNonzero,  ///< w ≠ 0: overlapping shells are united, a shell of the other orientation is a cavity
  kEvenOdd,  ///< w is odd: a shell in a shell is a cavity whatever its orientation, overlaps are hollow
  kOuter,    ///< as kNonzero after each component is turned outward: every shell is filled
};

/// The mesh with every component turned outward: parts that hang together by edges, vertices at identical
/// coordinates counting as one, run the other way if their signed volume is negative. That of an open one is
/// measured about the middle of its box.
[[nodiscard]] TriangleMesh turn_outward(TriangleMesh mesh);

}  // namespace mesocell
