#include "sdk/surface/color_field.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "sdk/core/closest_point.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

/// Beyond this, squares of distances lose what tells triangles apart.
constexpr double kMaxVoxelCoordinate = 0x1p40;

struct PaintedSurface {
  PaintedSurface(const TriangleMesh& voxel_mesh, const TriangleMesh& mesh, const SurfacePaint& paint,
                 unsigned threads)
      : surface(voxel_mesh, threads), sampler(mesh, paint, threads) {}
  ClosestPoint surface;  ///< in voxels
  PaintSampler sampler;
};

}  // namespace

Error mesh_without_colors() {
  return {ErrorCode::kUsage,
          "the mesh has no colors at its vertices or faces, nor materials, to take over; paint it in a mesh "
          "editor and save it as PLY, OBJ, COFF or glTF with them, or choose another color"};
}

Result<ColorField> make_mesh_color_field(const GridLayout& grid, const TriangleMesh& mesh,
                                         const SurfacePaint& paint, unsigned threads) {
  if (mesh.colors.empty() && paint.empty()) return mesh_without_colors();
  TriangleMesh voxel_mesh;
  voxel_mesh.triangles = mesh.triangles;
  voxel_mesh.vertices.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices)
    voxel_mesh.vertices.push_back((v - to_vec3(grid.box_min)) / grid.voxel_edge);
  const Box3 box = bounding_box(voxel_mesh);
  for (std::size_t a = 0; a < 3; ++a)
    if (!(box.min[a] > -kMaxVoxelCoordinate && box.max[a] < kMaxVoxelCoordinate && box.min[a] <= box.max[a]))
      return Error{
          ErrorCode::kInvalidInput,
          "the mesh whose colors are wanted has no triangles, or reaches more than 2^40 voxels beyond "
          "the grid; take the one that the object was made from"};
  return ColorField(
      [painted = std::make_shared<const PaintedSurface>(voxel_mesh, mesh, paint, threads)](Vec3 point) {
        const SurfacePoint nearest = painted->surface.query(point);
        return painted->sampler.color(nearest.triangle, nearest.barycentric);
      });
}

ColorField make_color_field(const GridLayout& grid, std::function<Rgb8(Vec3)> color_at) {
  return [corner = to_vec3(grid.box_min), edge = grid.voxel_edge, color_at = std::move(color_at)](
             Vec3 point) { return srgb_to_linear(color_at(corner + point * edge)); };
}

}  // namespace mesocell
