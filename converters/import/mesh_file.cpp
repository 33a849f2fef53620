#include "converters/import/mesh_file.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <filesystem>
#include <string_view>
#include <utility>

#include "converters/import/mesh_text.h"
#include "converters/import/openmesh_reader.h"
#include "converters/import/plain_mesh.h"
#include "converters/import/sniff.h"
#include "format/file.h"

namespace mesocell {
namespace {

/// One row a format.
struct MeshFormat {
  std::string_view extension, name,
      content;  ///< `content` as sniff_content() calls it, empty if it has no mark
  Result<PlainMesh> (*plain)(std::string_view, const Progress*);
};

constexpr std::array<MeshFormat, 4> kFormats = {{
    {".obj", "OBJ", "", plain_obj},
    {".off", "OFF", "an OFF mesh", plain_off},
    {".ply", "PLY", "a PLY mesh", plain_ply},
    {".stl", "STL", "", plain_stl},
}};

const MeshFormat* find_format(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  for (const MeshFormat& format : kFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

/// A FIFO or a device would be waited for or never end, so only plain files are read.
Status check_is_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return Error{ErrorCode::kUnreadable, "there is no such file; check the name"};
  if (status.type() == std::filesystem::file_type::directory)
    return Error{ErrorCode::kUnreadable, "it is a folder; name a mesh file in it"};
  if (error)
    return Error{ErrorCode::kUnreadable,
                 "it cannot be reached (" + error.message() + "); check its permissions"};
  if (status.type() != std::filesystem::file_type::regular)
    return Error{ErrorCode::kUnreadable, "it is not a regular file; copy its content into one"};
  return {};
}

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
  const std::size_t first = format.extension == ".obj" ? 1 : 0;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (!is_finite(mesh.vertices[v]))
        return invalid_mesh("vertex " + std::to_string(v + first) +
                            " has a coordinate that is not finite (NaN or infinite); repair the mesh");
  for (Vec3& vertex : mesh.vertices)
    if (!is_finite(vertex)) vertex = {};
  return {};
}

}  // namespace

bool is_readable_mesh(const std::string& path) { return find_format(path) != nullptr; }

Result<TriangleMesh> read_mesh_file(const std::string& path, const MeshReadOptions& options,
                                    MeshReadReport* report, const Progress* progress) {
  const MeshFormat* format = find_format(path);
  if (Status status = check_is_file(path); !status) return status.error();
  if (!format)
    return invalid_mesh(std::string("its extension is not one of a mesh that can be read; use ") +
                        kMeshExtensions);
  const Result<std::vector<std::byte>> file = read_file(path, options.max_file_bytes);
  if (!file) return file.error();
  const std::string_view bytes(reinterpret_cast<const char*>(file->data()), file->size());
  if (bytes.empty()) return invalid_mesh("the file is empty; fetch or export it again");
  const std::string_view content = sniff_content(bytes);
  if (!content.empty() && content != format->content)
    return invalid_mesh("the file is " + std::string(content) + ", not an " + std::string(format->name) +
                        " mesh; give it its proper extension, or convert it to one of " + kMeshExtensions);

  Result<PlainMesh> plain = format->plain(bytes, progress);
  if (!plain) return plain.error();
  MeshReadReport found;
  found.format = format->name;
  found.file_bytes = bytes.size();
  found.polygons = plain->polygons;
  found.dropped_faces = plain->dropped_faces;
  found.vertex_colors = !plain->colors.empty();
  Result<LibraryMesh> library = read_with_openmesh(*plain, progress);
  if (!library) return library.error();
  plain->bytes = {};
  Result<TriangleMesh> mesh = combine(std::move(*plain), std::move(*library));
  if (!mesh) return mesh;
  if (Status status = check_mesh(*mesh, found.polygons, *format); !status) return status.error();
  if (report) *report = found;
  return mesh;
}

}  // namespace mesocell
