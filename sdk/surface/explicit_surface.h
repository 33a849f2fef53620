#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// A box of tiles: from `begin` to below `end`.
struct TileBox {
  Index3 begin{}, end{};
  bool operator==(const TileBox&) const = default;
};

/// The surface of a set of voxels: the faces between its voxels and others, each a square of two triangles.
/// It is closed and every edge has exactly two triangles, which run along it in opposite directions; all
/// triangles of a vertex hang together by edges at it. Where the voxels' surface is not like that, vertices
/// stand several times at one place. Its volume is the number of voxels, exactly.
struct ExplicitSurface {
  /// In voxels from where whoever makes the surface says, so whole.
  std::vector<std::array<std::int32_t, 3>> vertices;
  /// Counter-clockwise from outside; the first corner is the square's minimum one.
  std::vector<std::array<std::uint32_t, 4>> squares;
  /// One a vertex, or empty. sRGB; the mean, in linear light, of the middles of the squares around it.
  std::vector<Rgb8> colors;
  /// One a vertex, or empty. Unit vectors; the mean of those of the squares around it.
  std::vector<std::array<float, 3>> normals;
  /// Vertices more than places of vertices.
  std::uint64_t split_vertices = 0;

  [[nodiscard]] std::uint64_t triangle_count() const { return 2 * std::uint64_t{squares.size()}; }
  [[nodiscard]] Triangle triangle(std::uint64_t k) const {
    const auto& s = squares[std::size_t(k / 2)];
    return k % 2 ? Triangle{s[0], s[2], s[3]} : Triangle{s[0], s[1], s[2]};
  }
};

/// The voxel that a square is a face of, and the face: 2 · axis, + 1 if its normal points up the axis.
struct SquareFace {
  std::array<std::int32_t, 3> voxel;
  int face;
};
[[nodiscard]] SquareFace face_of_square(const ExplicitSurface& surface, std::size_t square);

/// Where the normals of a surface come from.
enum class SurfaceNormals : std::uint8_t {
  kNone,
  kShading,  ///< as a caster shades the object, see Caster::shading_normal()
  kStored,   ///< the object's map; the face's own where that has none
};

struct SurfaceOptions {
  std::optional<TileBox> tiles;  ///< absent: all; where the box cuts voxels off others, there are faces
  std::uint64_t max_faces = 20'000'000;  ///< squares; at most 2^31 - 1 count
  bool colors = false;
  SurfaceNormals normals = SurfaceNormals::kNone;
  unsigned threads = 0;  ///< 0: the machine's; the result does not depend on it
};

/// How many squares make_explicit_surface() gives, counted without making them. Errors: as there, but for
/// max_faces.
[[nodiscard]] Result<std::uint64_t> count_surface_faces(const CellObject& object,
                                                        const SurfaceOptions& options = {},
                                                        const Progress* progress = nullptr);

/// The surface of the union of the INSIDE instances, vertices in voxels of the grid from its minimum corner.
/// Nothing inside gives an empty surface. `object` is valid (assert). Memory: 16 bytes a square and, with
/// vertices about as many, 24 a vertex, 15 more a vertex for colors, 24 for normals; and a caster where
/// attributes are asked for. Errors: kUsage (the box is empty or not in the grid, no stored normals), kLimit
/// (too many faces, with their number; nothing large was allocated then), kCancelled.
[[nodiscard]] Result<ExplicitSurface> make_explicit_surface(const CellObject& object,
                                                            const SurfaceOptions& options = {},
                                                            const Progress* progress = nullptr);

/// The surface of one instance of each cell, 1…cell_count in turn, across borders of tiles, vertices in
/// voxels from the minimum corner of its home tile. Errors: kLimit (the work takes more than `max_bytes`).
[[nodiscard]] Result<std::vector<ExplicitSurface>> make_cell_surfaces(const TileMap& tile,
                                                                      std::uint64_t max_bytes);

/// A point of the lattice in metres: the same number for the same point, always.
[[nodiscard]] inline Vec3 lattice_point(const GridLayout& grid, const std::array<std::int32_t, 3>& v) {
  return {grid.box_min[0] + v[0] * grid.voxel_edge, grid.box_min[1] + v[1] * grid.voxel_edge,
          grid.box_min[2] + v[2] * grid.voxel_edge};
}

/// Of one byte an INSIDE instance, in order of home tiles and then cells: 1 if a voxel of it has a face that
/// is one of the surface's, 0 if it is buried. Errors: kCancelled.
[[nodiscard]] Result<std::vector<std::uint8_t>> find_exposed_instances(const CellObject& object,
                                                                       unsigned threads = 0,
                                                                       const Progress* progress = nullptr);

}  // namespace mesocell
