#include "converters/export/mesh_export.h"

#include <chrono>

#include "converters/export/gltf_writer.h"
#include "converters/export/mesh_writer.h"
#include "converters/image/extension.h"

namespace mesocell {
namespace {

class Phases {
 public:
  explicit Phases(MeshExportReport& report) : report_(report) {}
  void end(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    report_.seconds.emplace_back(name, std::chrono::duration<double>(now - begin_).count());
    begin_ = now;
  }

 private:
  MeshExportReport& report_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void count(const ExplicitSurface& surface, MeshExportReport& report) {
  report.faces += surface.squares.size();
  report.triangles += surface.triangle_count();
  report.vertices += surface.vertices.size();
  report.split_vertices += surface.split_vertices;
}

Status write_instances(const CellObject& object, const std::string& path, const MeshExportOptions& options,
                       MeshExportReport& report, const Progress* progress) {
  Phases phases(report);
  // A face takes 16 bytes and its vertices, about as many as faces, 12 each; vectors may be half empty.
  constexpr std::uint64_t kFaceBytes = 64, kLeast = std::uint64_t{256} << 20;
  const std::uint64_t voxels = object.tile.voxel_count();
  const Result<std::vector<ExplicitSurface>> surfaces =
      make_cell_surfaces(object.tile, std::max(kLeast, options.max_faces * kFaceBytes) + 16 * voxels);
  if (!surfaces) return surfaces.error();
  for (const ExplicitSurface& surface : *surfaces) count(surface, report);
  if (report.faces > options.max_faces)
    return Error{ErrorCode::kLimit, "the cells have " + std::to_string(report.faces) +
                                        " faces of voxels, and " + std::to_string(options.max_faces) +
                                        " are allowed; allow more, or take a tile of fewer voxels"};
  phases.end("meshes of cells");
  std::vector<std::uint8_t> exposed;
  if (options.drop_buried) {
    Result<std::vector<std::uint8_t>> found = find_exposed_instances(object, options.threads, progress);
    if (!found) return found.error();
    exposed = std::move(*found);
    phases.end("buried instances");
  }
  std::vector<CellInstances> instances(object.tile.cell_count);
  std::size_t inside = 0;
  std::uint64_t tile = 0;
  Index3 t{};
  for (t[2] = 0; t[2] < object.grid.tiles[2]; ++t[2])
    for (t[1] = 0; t[1] < object.grid.tiles[1]; ++t[1])
      for (t[0] = 0; t[0] < object.grid.tiles[0]; ++t[0], ++tile)
        for (std::uint32_t cell = 1; cell <= object.tile.cell_count; ++cell) {
          if (object.membership.tag(tile, cell) != Tag::kInside) continue;
          const std::size_t k = inside++;
          if (options.drop_buried && !exposed[k]) {
            ++report.buried;
            continue;
          }
          instances[cell - 1].cell = cell;
          instances[cell - 1].homes.push_back(t);
          if (options.colors && object.instance_colors)
            instances[cell - 1].colors.push_back(object.instance_colors->colors[k]);
          ++report.instances;
        }
  if (options.colors && object.instance_colors)
    report.losses.push_back(
        "colors of single instances are in an attribute, _COLOR_0, which few readers know");
  if (options.colors && object.surface_colors)
    report.losses.push_back("colors of the surface are not written with instances");
  if (options.colors && object.color)
    report.losses.push_back("the color map of the tile is not written with instances");
  GltfOptions gltf;
  gltf.draco = options.draco;
  gltf.cell_colors = options.colors;
  gltf.no_clobber = options.no_clobber;
  const Status written =
      write_instanced_gltf(object, *surfaces, instances, path, gltf, &report.bytes, progress);
  phases.end("writing");
  return written;
}

}  // namespace

bool is_mesh_export(const std::string& path) {
  return lower_extension(path) == ".glb" || is_writable_mesh(path);
}

Status write_mesh_export(const CellObject& object, const std::string& path, const MeshExportOptions& options,
                         MeshExportReport* report, const Progress* progress) {
  MeshExportReport own;
  MeshExportReport& told = report ? *report : own;
  told = {};
  const bool glb = lower_extension(path) == ".glb";
  if (!is_mesh_export(path))
    return Error{ErrorCode::kUsage,
                 std::string("meshes are written as ") + kMeshExportExtensions + "; name the file so"};
  if (!glb && (options.draco || options.instanced))
    return Error{ErrorCode::kUsage, "Draco and instances are for GLB; name the file .glb"};
  if (!options.instanced && options.drop_buried)
    return Error{ErrorCode::kUsage, "a surface has no buried instances to drop; write instances"};
  if (options.instanced && (options.tiles || options.normals != SurfaceNormals::kNone))
    return Error{ErrorCode::kUsage, "instances are written whole and without normals"};
  if (options.instanced) return write_instances(object, path, options, told, progress);

  Phases phases(told);
  SurfaceOptions wanted;
  wanted.tiles = options.tiles;
  wanted.max_faces = options.max_faces;
  wanted.colors = options.colors &&
                  (object.color || object.cell_colors || object.instance_colors || object.surface_colors);
  wanted.normals = options.normals;
  wanted.threads = options.threads;
  const Result<ExplicitSurface> surface = make_explicit_surface(object, wanted, progress);
  if (!surface) return surface.error();
  count(*surface, told);
  phases.end("surface");
  if (wanted.colors) told.losses.push_back("colors are those of vertices, the mean of the faces around each");
  Status written;
  if (glb) {
    GltfOptions gltf;
    gltf.draco = options.draco;
    gltf.no_clobber = options.no_clobber;
    if (options.draco && wanted.normals != SurfaceNormals::kNone)
      told.losses.push_back("normals are rounded to 10 bits a coordinate by Draco");
    written = write_gltf(*surface, object.grid, path, gltf, &told.bytes, progress);
  } else {
    if (surface->squares.empty())
      return Error{ErrorCode::kLimit, "nothing is inside, and a mesh without triangles is of no use"};
    MeshWriteOptions plain;
    plain.no_clobber = options.no_clobber;
    MeshWriteReport of_file;
    written = write_mesh_file(view_of(*surface, object.grid), path, plain, &of_file, progress);
    told.bytes = of_file.bytes;
    told.losses.insert(told.losses.end(), of_file.losses.begin(), of_file.losses.end());
  }
  phases.end("writing");
  return written;
}

}  // namespace mesocell
