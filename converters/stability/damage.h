#pragma once

#include <cstdint>
#include <span>

#include "sdk/core/triangle_mesh.h"

/// Damage of known strength to a clean mesh; the same for the same seed on every machine. Vertices keep their
/// numbers unless told otherwise. Shares are of all triangles or of the area, distances of the diagonal of
/// the mesh's box.
namespace mesocell {

struct Damage {
  const char* name;         ///< for tables, such as "holes"
  const char* description;  ///< one line
  const char* unit;         ///< of a strength: "of the area", "of the triangles" or "of the diagonal"
  /// `strength`: from 0 to 1.
  TriangleMesh (*apply)(const TriangleMesh& mesh, double strength, std::uint64_t seed);
};

/// All kinds of damage, in the order of the tables.
[[nodiscard]] std::span<const Damage> damages();

/// Takes out up to three connected patches, together of this share of the area to within a triangle each.
[[nodiscard]] TriangleMesh punch_holes(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Takes out triangles here and there.
[[nodiscard]] TriangleMesh remove_triangles(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Turns triangles here and there.
[[nodiscard]] TriangleMesh flip_triangles(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Gives triangles a second time.
[[nodiscard]] TriangleMesh duplicate_triangles(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Gives triangles a second time, turned.
[[nodiscard]] TriangleMesh duplicate_turned(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Moves vertices by up to `amount` along each axis; the mesh stays closed.
[[nodiscard]] TriangleMesh jitter_vertices(const TriangleMesh& mesh, double amount, std::uint64_t seed);
/// Moves every corner of every triangle by itself, by up to `amount` along each axis.
[[nodiscard]] TriangleMesh jitter_corners(const TriangleMesh& mesh, double amount, std::uint64_t seed);
/// Cuts the mesh into twelve connected patches and moves each by up to `amount` along each axis.
[[nodiscard]] TriangleMesh crack(const TriangleMesh& mesh, double amount, std::uint64_t seed);
/// Throws one corner of triangles here and there away by half the diagonal, off their neighbours.
[[nodiscard]] TriangleMesh add_spikes(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Cuts triangles in two at the middle of an edge and fills the crack with a triangle without area to
/// rounding.
[[nodiscard]] TriangleMesh add_slivers(const TriangleMesh& mesh, double share, std::uint64_t seed);
/// Adds copies of connected patches, moved inward by a fiftieth of the diagonal: faces inside, open.
[[nodiscard]] TriangleMesh add_internal_faces(const TriangleMesh& mesh, double share, std::uint64_t seed);

/// Triangles of up to `patches` connected parts of the mesh, about equal, together of a share of the area
/// that is exceeded by at most a triangle each.
[[nodiscard]] std::vector<std::uint32_t> connected_patches(const TriangleMesh& mesh, double share,
                                                           std::uint32_t patches, std::uint64_t seed);

}  // namespace mesocell
