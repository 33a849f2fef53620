#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"

namespace mesocell {

/// A voxel's face as a square of a mesh remembers it: 20 bits a coordinate, then the face as StreamHit's.
class PackedFace {
 public:
  static constexpr std::int32_t kLimit = 1 << 19;  ///< coordinates are in [-kLimit, kLimit)

  PackedFace(const std::array<std::int32_t, 3>& voxel, int face) : bits_(std::uint64_t(face) << 60) {
    for (std::size_t a = 0; a < 3; ++a) bits_ |= std::uint64_t(voxel[a] + kLimit) << (20 * a);
  }
  [[nodiscard]] std::array<std::int32_t, 3> voxel() const {
    std::array<std::int32_t, 3> v{};
    for (std::size_t a = 0; a < 3; ++a) v[a] = std::int32_t(bits_ >> (20 * a) & 0xfffff) - kLimit;
    return v;
  }
  [[nodiscard]] int face() const { return int(bits_ >> 60); }

 private:
  std::uint64_t bits_;
};

/// The faces between voxels of a set and others, a square each; corners are whole voxels, shared as
/// ExplicitSurface has them.
struct FaceMesh {
  std::vector<float> corners;        ///< three a corner, voxels
  std::vector<std::uint32_t> quads;  ///< four corners a square, around it
  std::vector<PackedFace> faces;     ///< one a square

  [[nodiscard]] std::uint64_t memory_bytes() const {
    return corners.capacity() * sizeof(float) + quads.capacity() * sizeof(std::uint32_t) +
           faces.capacity() * sizeof(PackedFace);
  }
};

/// A mesh of each cell, 1…cell_count in turn: the faces of all voxels of one instance of it, across borders
/// of tiles, in voxels from the minimum corner of its home tile. Errors: kLimit (the work takes more than
/// `max_bytes`).
[[nodiscard]] Result<std::vector<FaceMesh>> make_cell_meshes(const TileMap& tile, std::uint64_t max_bytes);

/// The mesh of the union of all INSIDE instances; voxels of the mesh are grid's less `centre`. Errors: kLimit
/// (more than `max_faces` squares, or a grid of more than 2^19 voxels along an axis).
[[nodiscard]] Result<FaceMesh> make_union_mesh(const CellObject& object,
                                               const std::array<std::int32_t, 3>& centre,
                                               std::uint64_t max_faces);

}  // namespace mesocell
