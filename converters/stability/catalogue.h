#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// A mesh and a sound one that says what is inside, in voxel units of a grid.
struct StabilityCase {
  std::string group;     ///< "clean", "damage", "geometry" or "pair"
  std::string name;      ///< what is done to it, such as "holes"
  std::string strength;  ///< such as "1 %"; empty where there is none
  std::string mesh;      ///< which one, such as "knot"
  TriangleMesh broken;
  TriangleMesh sound;
  Index3 size{};  ///< voxels

  /// Name and strength: the row of the tables.
  [[nodiscard]] std::string row() const { return strength.empty() ? name : name + " " + strength; }
};

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

/// A broken mesh and its sound twin, in the same place.
struct MeshPair {
  std::string name;
  TriangleMesh broken, sound;
};

/// The clean meshes that are damaged if the user gives none; about 2000 triangles times `detail`².
[[nodiscard]] std::vector<NamedMesh> clean_meshes(std::uint32_t detail = 1);

/// The grid of a mesh: `resolution` voxels along the longest side of its box, three of them free at each end.
struct VoxelFrame {
  Vec3 origin;
  double voxel_edge = 1;
  Index3 size{};

  [[nodiscard]] TriangleMesh to_voxels(const TriangleMesh& mesh) const;
};
/// `resolution`: at least 8 (assert). The mesh has an extent.
[[nodiscard]] VoxelFrame frame_of(const TriangleMesh& mesh, std::uint32_t resolution);

/// Each mesh as it is, and each kind and strength of damage to each mesh.
[[nodiscard]] std::vector<StabilityCase> damage_cases(std::span<const NamedMesh> meshes,
                                                      std::uint32_t resolution);

/// Sound meshes that are hard on a grid: nested shells, overlapping solids, faces and vertices in special
/// places, thin walls.
[[nodiscard]] std::vector<StabilityCase> geometry_cases(std::uint32_t resolution);

/// For a benchmark: each mesh as it is and with holes of 1 % of its area.
[[nodiscard]] std::vector<StabilityCase> benchmark_cases(std::span<const NamedMesh> meshes,
                                                         std::uint32_t resolution);

[[nodiscard]] StabilityCase pair_case(const MeshPair& pair, std::uint32_t resolution);

}  // namespace mesocell
