#include "converters/bench/peers/face_mesh.h"

#include <string>
#include <utility>

#include "sdk/surface/explicit_surface.h"

namespace mesocell {
namespace {

/// A surface less `centre`; what it has is freed as it is taken over.
FaceMesh to_face_mesh(ExplicitSurface surface, const std::array<std::int32_t, 3>& centre) {
  FaceMesh mesh;
  mesh.faces.reserve(surface.squares.size());
  mesh.quads.reserve(4 * surface.squares.size());
  for (std::size_t k = 0; k < surface.squares.size(); ++k) {
    SquareFace f = face_of_square(surface, k);
    for (std::size_t a = 0; a < 3; ++a) f.voxel[a] -= centre[a];
    mesh.faces.push_back(PackedFace(f.voxel, f.face));
    for (const std::uint32_t corner : surface.squares[k]) mesh.quads.push_back(corner);
  }
  surface.squares = {};
  mesh.corners.reserve(3 * surface.vertices.size());
  for (const auto& v : surface.vertices)
    for (std::size_t a = 0; a < 3; ++a) mesh.corners.push_back(float(v[a] - centre[a]));
  return mesh;
}

}  // namespace

Result<std::vector<FaceMesh>> make_cell_meshes(const TileMap& tile, std::uint64_t max_bytes) {
  Result<std::vector<ExplicitSurface>> surfaces = make_cell_surfaces(tile, max_bytes);
  if (!surfaces) return surfaces.error();
  std::vector<FaceMesh> meshes;
  meshes.reserve(surfaces->size());
  for (ExplicitSurface& surface : *surfaces) meshes.push_back(to_face_mesh(std::move(surface), {}));
  return meshes;
}

Result<FaceMesh> make_union_mesh(const CellObject& object, const std::array<std::int32_t, 3>& centre,
                                 std::uint64_t max_faces) {
  for (std::size_t a = 0; a < 3; ++a)
    if (std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a] > std::uint64_t(PackedFace::kLimit))
      return Error{ErrorCode::kLimit, "a mesh of the whole surface takes at most " +
                                          std::to_string(PackedFace::kLimit) + " voxels along an axis"};
  SurfaceOptions options;
  options.max_faces = max_faces;
  Result<ExplicitSurface> surface = make_explicit_surface(object, options);
  if (!surface) return surface.error();
  return to_face_mesh(std::move(*surface), centre);
}

}  // namespace mesocell
