#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "format/api.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// The faces between solid and empty voxels around a point of the lattice, as fans: each is a ring of faces
/// that hang together by edges, and gets a vertex of its own. Around the point there are eight voxels, bit
/// dx + 2·dy + 4·dz of a configuration for that which is dx, dy, dz ∈ {0, 1} up the axes, and places for
/// twelve faces: see fan_face().
///
/// Where four faces meet at an edge, two solid voxels and two empty ones take turns around it. The faces of
/// each solid voxel are paired there, as if it ended at the edge. Both pairs can then be in one fan, as the
/// solid goes around an empty voxel. An edge that has that at both of its ends would have four triangles; it
/// is *turned*: the faces of each empty voxel are paired instead, which splits the fan at both ends. Turning
/// one edge never joins fans, nor undoes what turning another does: on a sphere around the point a fan is a
/// simple closed curve, and the places where it touches itself are joined outside of it by arcs that do not
/// cross. So each edge is decided by its two configurations alone.
struct VertexFans {
  std::uint8_t count = 0;                  ///< 0…4
  std::array<std::uint8_t, 12> of_face{};  ///< the fan of each face that is there
};

/// Place of the face between two voxels along `axis`, whose bits on the axes after that, in turn, are u and
/// w.
[[nodiscard]] constexpr std::size_t fan_face(std::size_t axis, std::size_t u, std::size_t w) {
  return 4 * axis + u + 2 * w;
}

/// The fans of a configuration. Bit 2·axis + up of `turned` says that the edge from the point along the axis,
/// up or down it, is turned.
[[nodiscard]] VertexFans find_fans(std::uint8_t configuration, std::uint8_t turned);

/// What is known of all configurations whose edges are not turned.
struct FanTable {
  std::array<VertexFans, 256> fans;
  /// The edges, as in find_fans(), at which four faces of one fan meet: those to turn if the point at their
  /// other end says so too.
  std::array<std::uint8_t, 256> doubled;
  std::array<std::uint8_t, 256> plain;  ///< whether there is one fan, whatever is turned
};
[[nodiscard]] const FanTable& fan_table();

}  // namespace mesocell
