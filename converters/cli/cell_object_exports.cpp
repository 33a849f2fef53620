#include "converters/cli/cell_object_exports.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "converters/cli/values.h"
#include "converters/export/basic_mesh.h"
#include "converters/export/gpu_textures.h"
#include "converters/export/height_map.h"
#include "converters/export/image_stack.h"
#include "converters/export/mesh_export.h"
#include "converters/export/mesh_writer.h"
#include "converters/vdb/vdb_export.h"
#include "format/file.h"

namespace mesocell {
namespace {

void add_losses(const std::vector<std::string>& from, const ExportJob& job) {
  job.losses.insert(job.losses.end(), from.begin(), from.end());
}

Status export_stack(const ExportJob& job, StackMap map) {
  StackExportReport report;
  const Status status =
      write_image_stack(job.object, map, job.command.output, job.command.no_clobber, &report, &job.progress);
  job.report["slices"] = report.slices;
  job.report["bytes"] = report.bytes;
  add_losses(report.losses, job);
  return status;
}
Status export_cells(const ExportJob& job) { return export_stack(job, StackMap::kCells); }
Status export_colors(const ExportJob& job) { return export_stack(job, StackMap::kColors); }
Status export_normals(const ExportJob& job) { return export_stack(job, StackMap::kNormals); }

Status export_heights(const ExportJob& job) {
  HeightMapOptions options{.no_clobber = job.command.no_clobber, .threads = job.command.common.threads};
  constexpr std::array<std::string_view, 6> kSides = {"-x", "+x", "-y", "+y", "-z", "+z"};
  const std::string side = job.command.side.value_or("+y");
  const auto found = std::find(kSides.begin(), kSides.end(), side);
  if (found == kSides.end())
    return Error{ErrorCode::kUsage, "--side: unknown side '" + side + "'; there are: -x, +x, -y, +y, -z, +z"};
  options.axis = int((found - kSides.begin()) / 2);
  options.from_low = (found - kSides.begin()) % 2 == 0;
  if (job.command.size) {
    const auto size = parse_size(*job.command.size);
    if (!size) return Error{ErrorCode::kUsage, "--size: " + size.error().message};
    options.size = *size;
  }
  HeightMapReport report;
  const Status status = write_height_map(job.object, job.command.output, options, &report, &job.progress);
  job.report["size"] = {report.width, report.height};
  job.report["missing"] = report.missing;
  job.report["heights"] = report.heights;
  job.report["bytes"] = report.bytes;
  add_losses(report.losses, job);
  return status;
}

Status export_gpu(const ExportJob& job) {
  std::uint64_t bytes = 0;
  const Status status = write_gpu_textures(job.object, job.command.output, job.command.no_clobber, &bytes);
  job.report["bytes"] = bytes;
  add_losses({"colors of cells, instances and the surface, normals, metadata"}, job);
  return status;
}

/// "0,0,0,8,8,8": the tiles from a first one up to one beyond the last.
Status parse_region(const ExportJob& job, std::optional<TileBox>& box) {
  if (!job.command.region) return {};
  const auto numbers = parse_numbers<6>(*job.command.region);
  if (!numbers) return Error{ErrorCode::kUsage, "--region: " + numbers.error().message};
  box.emplace();
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = (*numbers)[a], high = (*numbers)[a + 3];
    if (low != std::floor(low) || high != std::floor(high) || low < 0 || !(low < high) ||
        high > job.object.grid.tiles[a])
      return Error{ErrorCode::kUsage, "--region: the object has tiles from 0,0,0 up to " +
                                          std::to_string(job.object.grid.tiles[0]) + "," +
                                          std::to_string(job.object.grid.tiles[1]) + "," +
                                          std::to_string(job.object.grid.tiles[2]) +
                                          "; name the first tile, then the one beyond the last"};
    box->begin[a] = std::uint32_t(low);
    box->end[a] = std::uint32_t(high);
  }
  return {};
}

Status export_mesh(const ExportJob& job, bool instanced) {
  const ConvertCommand& command = job.command;
  MeshExportOptions options;
  if (Status status = parse_region(job, options.tiles); !status) return status;
  if (command.max_faces) options.max_faces = *command.max_faces;
  if (command.normals) options.normals = SurfaceNormals::kShading;
  options.colors = true;
  options.draco = command.draco;
  options.instanced = instanced;
  options.drop_buried = command.drop_buried;
  options.no_clobber = command.no_clobber;
  options.threads = command.common.threads;
  MeshExportReport report;
  const Status status = write_mesh_export(job.object, command.output, options, &report, &job.progress);
  for (const auto& [key, value] :
       std::initializer_list<std::pair<const char*, std::uint64_t>>{{"faces", report.faces},
                                                                    {"triangles", report.triangles},
                                                                    {"vertices", report.vertices},
                                                                    {"split_vertices", report.split_vertices},
                                                                    {"instances", report.instances},
                                                                    {"buried", report.buried},
                                                                    {"bytes", report.bytes}})
    job.report[key] = value;
  for (const auto& [phase, seconds] : report.seconds) job.report["seconds"][phase] = seconds;
  add_losses(report.losses, job);
  return status;
}
Status export_surface(const ExportJob& job) { return export_mesh(job, false); }
Status export_instances(const ExportJob& job) { return export_mesh(job, true); }

Status export_grids(const ExportJob& job, const VdbKinds& kinds) {
  VdbExportOptions options{
      .kinds = kinds, .no_clobber = job.command.no_clobber, .threads = job.command.common.threads};
  if (Status status = parse_region(job, options.tiles); !status) return status;
  VdbExportReport report;
  const Status status = export_vdb(job.object, job.command.output, options, &report, &job.progress);
  for (const VdbExportReport::Grid& grid : report.grids) job.report["grids"][grid.name] = grid.voxels;
  job.report["bytes"] = report.bytes;
  add_losses(report.losses, job);
  return status;
}
Status export_level_set(const ExportJob& job) { return export_grids(job, {.level_set = true}); }
Status export_fog(const ExportJob& job) { return export_grids(job, {.fog = true}); }
Status export_labels(const ExportJob& job) { return export_grids(job, {.labels = true}); }
Status export_color_grid(const ExportJob& job) { return export_grids(job, {.fog = true, .colors = true}); }

Status export_basic_mesh(const ExportJob& job) {
  if (!job.object.basic_mesh)
    return Error{ErrorCode::kUsage,
                 "the asset does not hold its basic mesh; convert the mesh with --keep-mesh"};
  const BasicMesh& kept = *job.object.basic_mesh;
  job.report["vertices"] = kept.vertices;
  job.report["triangles"] = kept.triangles;
  job.report["max_error"] = kept.max_error;
  char text[96];
  std::snprintf(text, sizeof text, "vertices are up to %.3g m from where they were", double(kept.max_error));
  add_losses({text, "materials and colors of faces"}, job);
  if (has_extension(job.command.output, ".drc")) {
    job.report["bytes"] = kept.draco.size();
    return write_file(job.command.output, kept.draco, job.command.no_clobber);
  }
  const Result<TriangleMesh> mesh = read_basic_mesh(kept, &job.progress);
  if (!mesh) return mesh.error();
  MeshWriteReport report;
  const Status status = write_mesh_file(view_of(*mesh), job.command.output,
                                        {.no_clobber = job.command.no_clobber}, &report, &job.progress);
  job.report["bytes"] = report.bytes;
  add_losses(report.losses, job);
  return status;
}

constexpr ExportKind kKinds[] = {
    {"surface", ".glb .obj .off .ply .stl", "the surface as a closed mesh, two triangles a voxel's face",
     "--region --max-faces --normals --draco", export_surface},
    {"instances", ".glb", "a mesh of each cell, placed wherever it is inside (EXT_mesh_gpu_instancing)",
     "--max-faces --normals --draco --drop-buried", export_instances},
    {"basic-mesh", ".drc .obj .off .ply .stl", "the mesh that it was made of, if it was kept", "",
     export_basic_mesh},
    {"level-set", ".vdb", "distances to the surface", "--region", export_level_set},
    {"fog", ".vdb", "1 inside, 0 elsewhere", "--region", export_fog},
    {"labels", ".vdb", "cells, membership and tile; converts back to an equal asset", "", export_labels},
    {"colors", ".vdb", "fog, and the color at each voxel inside", "--region", export_color_grid},
    {"tile", "/ .tif .tiff .exr", "the cells of the tile, a stack of pictures", "", export_cells},
    {"color", "/ .tif .tiff .exr", "the colors in the tile, a stack of pictures", "", export_colors},
    {"normal", "/ .tif .tiff .exr", "the normals of the tile, a stack of pictures", "", export_normals},
    {"height", ".png .exr .tif .tiff", "a map of heights, seen from --side", " --side --size ",
     export_heights},
    {"gpu", ".json", "textures for a GPU: raw files, and a JSON that says what they are", "", export_gpu},
};

}  // namespace

std::span<const ExportKind> cell_object_exports() { return kKinds; }

}  // namespace mesocell
