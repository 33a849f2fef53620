#include "converters/import/mesh_file.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <span>
#include <string_view>
#include <utility>

#include "converters/image/extension.h"
#include "converters/import/gltf_file.h"
#include "converters/import/mesh_format.h"
#include "converters/import/mesh_materials.h"
#include "converters/import/mesh_text.h"
#include "converters/import/openmesh_reader.h"
#include "converters/import/plain_file.h"
#include "converters/import/plain_mesh.h"
#include "converters/import/sniff.h"

namespace mesocell {
namespace {

/// Whether a position and the library's reading of it are the same number, but for its precision.
bool agrees(const Vec3& position, const std::array<float, 3>& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = library_holds(position[axis]) ? position[axis] : 0.0;
    if (!(std::abs(double{point[axis]} - x) <= 1e-6 * std::abs(x) + double{FLT_MIN})) return false;
  }
  return true;
}

/// Compares what the library read with what is in the file, and keeps the file's positions.
Result<TriangleMesh> combine(PlainMesh plain, LibraryMesh library) {
  const Error differs = invalid_mesh(
      "the mesh library reads the file differently from what stands in it; export the mesh again, in another "
      "format");
  if (library.triangles.size() != plain.triangles) return differs;
  TriangleMesh mesh;
  if (plain.positions.empty()) {
    mesh.vertices.reserve(library.points.size());
    for (const std::array<float, 3>& p : library.points) mesh.vertices.push_back({p[0], p[1], p[2]});
  } else {
    if (library.points.size() != plain.positions.size()) return differs;
    for (std::size_t i = 0; i < library.points.size(); ++i)
      if (!agrees(plain.positions[i], library.points[i])) return differs;
    mesh.vertices = std::move(plain.positions);
  }
  mesh.triangles = std::move(library.triangles);
  mesh.colors = std::move(plain.colors);
  return mesh;
}

/// Refuses a mesh without triangles or with a corner at no place; a vertex at no place that no face uses is
/// put at the origin, where it harms nobody.
Status check_mesh(TriangleMesh& mesh, std::uint64_t polygons, const MeshFormat& format) {
  if (mesh.triangles.empty())
    return invalid_mesh(polygons == 0
                            ? "the mesh has no triangles; a closed surface is needed"
                            : "the mesh has no triangles but those with two equal corners; repair the mesh");
  // OBJ counts from 1: the message names the vertex as the file does.
  const std::size_t first = format.kind == MeshKind::kObj ? 1 : 0;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (!is_finite(mesh.vertices[v]))
        return invalid_mesh("vertex " + std::to_string(v + first) +
                            " has a coordinate that is not finite (NaN or infinite); repair the mesh");
  for (Vec3& vertex : mesh.vertices)
    if (!is_finite(vertex)) vertex = {};
  return {};
}

/// The format of a file: its content's, if that shows one, else its name's.
Result<const MeshFormat*> choose_format(const std::string& path, std::string_view bytes,
                                        std::vector<MeshWarning>& warnings) {
  const MeshFormat* named = format_by_extension(path);
  std::string_view other;
  const MeshFormat* found = format_by_content(bytes, other);
  if (!found && other.empty()) other = sniff_name(lower_extension(path), bytes.size());
  if (const std::string_view remedy = terrain_remedy(other); !found && !remedy.empty())
    return invalid_mesh("the file is " + std::string(other) + ", which is not read; " + std::string(remedy));
  if (!found && !other.empty())
    return invalid_mesh("the file is " + std::string(other) +
                        ", not a mesh; give it its proper extension, or " + "convert it to one of " +
                        kMeshExtensions);
  if (!found && !named)
    return invalid_mesh(
        std::string("neither its content nor its extension is one of a mesh that can be read; use ") +
        kMeshExtensions);
  if (!found) return named;
  const std::string extension = lower_extension(path);
  if (found != named)
    warnings.push_back({"renamed", "the file is " + std::string(found->name) + ", though its name ends in " +
                                       (extension.empty() ? "nothing that says so" : extension) +
                                       "; it was read as " + std::string(found->name)});
  return found;
}

/// Reads what mesocell_mesh_worker knows.
Result<PaintedMesh> read_by_worker(const MeshFormat& format, std::span<const std::byte> bytes,
                                   const std::string& path, const MeshReadOptions& options,
                                   const Progress* progress, MeshReadReport& found) {
  Result<WorkerMesh> read = format.kind == MeshKind::kDraco
                                ? read_draco(bytes, progress)
                                : read_gltf(bytes, path, options.max_file_bytes, found.notes, progress);
  if (!read) return read.error();
  found.polygons = read->polygons;
  found.dropped_faces = read->dropped_faces;
  found.warnings.insert(found.warnings.end(), read->warnings.begin(), read->warnings.end());
  found.notes.add(read->notes);
  return std::move(read->painted);
}

/// Reads a file that is checked in full before OpenMesh sees it.
Result<PaintedMesh> read_plain(const MeshFormat& format, std::string_view bytes, const std::string& path,
                               const MeshReadOptions& options, bool paint, const Progress* progress,
                               MeshReadReport& found) {
  Result<PlainMesh> plain = format.plain(bytes, progress);
  if (!plain) return plain.error();
  found.polygons = plain->polygons;
  found.dropped_faces = plain->dropped_faces;
  found.warnings.insert(found.warnings.end(), plain->warnings.begin(), plain->warnings.end());
  Result<LibraryMesh> library = read_with_openmesh(*plain, progress);
  if (!library) return library.error();
  plain->bytes = {};
  found.notes.add(plain->notes);
  const bool has_uvs = !plain->paint.uvs.empty(), has_materials = !plain->materials.empty();
  if (paint && options.texture.empty())
    if (Status status = read_materials(path, *plain, found.warnings, found.notes, progress); !status)
      return status.error();
  PaintedMesh painted;
  painted.paint = std::move(plain->paint);
  const std::vector<PaintMaterial>& materials = painted.paint.materials;
  const bool has_texture = std::any_of(materials.begin(), materials.end(), [](const PaintMaterial& material) {
    return material.texture.has_value();
  });
  if (has_uvs && !has_texture && (!paint || options.texture.empty())) found.notes.lose("texture coordinates");
  if (has_materials && materials.empty()) found.notes.lose("materials");
  Result<TriangleMesh> mesh = combine(std::move(*plain), std::move(*library));
  if (!mesh) return mesh.error();
  painted.mesh = std::move(*mesh);
  return painted;
}

/// For who wants no more than colors of vertices.
void drop_paint(PaintedMesh& painted, ReadNotes& notes) {
  SurfacePaint& paint = painted.paint;
  if (!paint.face_colors.empty()) notes.lose("colors of faces");
  if (!paint.materials.empty()) notes.lose("materials");
  if (!paint.uvs.empty()) notes.lose("texture coordinates");
  paint = {};
}

Result<PaintedMesh> read(const std::string& path, const MeshReadOptions& options, bool paint,
                         MeshReadReport* report, const Progress* progress) {
  const Result<std::vector<std::byte>> file = read_plain_file(path, options.max_file_bytes);
  if (!file) return file.error();
  const std::string_view bytes(reinterpret_cast<const char*>(file->data()), file->size());
  if (bytes.empty()) return invalid_mesh("the file is empty; fetch or export it again");
  MeshReadReport found;
  const Result<const MeshFormat*> format = choose_format(path, bytes, found.warnings);
  if (!format) return format.error();
  found.format = (*format)->name;
  found.file_bytes = bytes.size();
  Result<PaintedMesh> painted = (*format)->plain
                                    ? read_plain(**format, bytes, path, options, paint, progress, found)
                                    : read_by_worker(**format, *file, path, options, progress, found);
  if (!painted) return painted;
  if (Status status = check_mesh(painted->mesh, found.polygons, **format); !status) return status.error();
  if (paint && !options.texture.empty()) {
    found.notes.files.insert(options.texture);
    if (!painted->paint.materials.empty()) found.notes.lose("materials");
    if (Status status =
            use_texture(options.texture, painted->mesh.triangles.size(), painted->paint, progress);
        !status)
      return status.error();
  }
  if (!paint) drop_paint(*painted, found.notes);
  found.vertex_colors = !painted->mesh.colors.empty();
  if (report) *report = std::move(found);
  return painted;
}

}  // namespace

bool is_readable_mesh(const std::string& path) { return format_by_extension(path) != nullptr; }

Result<PaintedMesh> read_painted_mesh(const std::string& path, const MeshReadOptions& options,
                                      MeshReadReport* report, const Progress* progress) {
  return read(path, options, true, report, progress);
}

Result<TriangleMesh> read_mesh_file(const std::string& path, const MeshReadOptions& options,
                                    MeshReadReport* report, const Progress* progress) {
  Result<PaintedMesh> painted = read(path, options, false, report, progress);
  if (!painted) return painted.error();
  return std::move(painted->mesh);
}

}  // namespace mesocell
