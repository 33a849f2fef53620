#include "converters/export/mesh_writer.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "converters/export/mesh_formats.h"
#include "converters/image/extension.h"

namespace mesocell {
namespace {

struct Format {
  const char* extension;
  void (*write)(const MeshView&, FileStream&, WriteProgress&);
};
constexpr std::array<Format, 4> kFormats = {
    {{".obj", write_obj}, {".off", write_off}, {".ply", write_ply}, {".stl", write_stl}}};

const Format* format_of(const std::string& path) {
  const std::string extension = lower_extension(path);
  const auto* const found = std::find_if(kFormats.begin(), kFormats.end(),
                                         [&](const Format& f) { return f.extension == extension; });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace

MeshView view_of(const ExplicitSurface& surface, const GridLayout& grid) {
  MeshView view;
  view.vertex_count = surface.vertices.size();
  view.triangle_count = surface.triangle_count();
  view.position = [&surface, &grid](std::uint64_t v) {
    return lattice_point(grid, surface.vertices[std::size_t(v)]);
  };
  view.triangle = [&surface](std::uint64_t k) { return surface.triangle(k); };
  view.colors = surface.colors;
  view.normals = surface.normals;
  // Half of it may be lost to rounding far from the origin.
  view.least_step = 0.5 * grid.voxel_edge;
  return view;
}

MeshView view_of(const TriangleMesh& mesh) {
  MeshView view;
  view.vertex_count = mesh.vertices.size();
  view.triangle_count = mesh.triangles.size();
  view.position = [&mesh](std::uint64_t v) { return mesh.vertices[std::size_t(v)]; };
  view.triangle = [&mesh](std::uint64_t k) { return mesh.triangles[std::size_t(k)]; };
  view.colors = mesh.colors;
  return view;
}

bool is_writable_mesh(const std::string& path) { return format_of(path) != nullptr; }

Status write_mesh_file(const MeshView& mesh, const std::string& path, const MeshWriteOptions& options,
                       MeshWriteReport* report, const Progress* progress) {
  const Format* const format = format_of(path);
  if (!format)
    return Error{ErrorCode::kUsage,
                 std::string("meshes are written as ") + kMeshWriterExtensions + "; name the file so"};
  MeshWriteReport own;
  MeshWriteReport& told = report ? *report : own;
  const bool stl = format->write == write_stl;
  if (stl) {
    if (mesh.triangle_count > 0xffffffffu)
      return Error{ErrorCode::kLimit, "an STL file has at most 2^32 - 1 triangles; write PLY"};
    const SingleRounding rounding = round_to_single(mesh);
    if (rounding.merges)
      return Error{
          ErrorCode::kLimit,
          "in the single precision of STL vertices at different places would be at one, for the mesh is "
          "far from the origin for its detail; write PLY, OBJ or OFF"};
    if (rounding.greatest_move > 0) {
      char metres[32];
      std::snprintf(metres, sizeof metres, "%.3g", rounding.greatest_move);
      told.losses.push_back(std::string("positions are rounded to single precision, by at most ") + metres +
                            " m");
    }
    if (!mesh.colors.empty()) told.losses.push_back("STL has no colors of vertices");
  }
  if ((stl || format->write == write_off) && !mesh.normals.empty())
    told.losses.push_back(stl ? "STL has no normals of vertices, but of triangles"
                              : "normals are not written to OFF");
  Result<FileStream> out = FileStream::create(path, options.no_clobber);
  if (!out) return out.error();
  WriteProgress writing(mesh, *out, progress);
  format->write(mesh, *out, writing);
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  told.bytes = out->size();
  return out->finish();
}

}  // namespace mesocell
