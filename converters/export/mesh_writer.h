#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/surface/explicit_surface.h"

namespace mesocell {

/// A mesh to be written, which is looked at piece by piece.
struct MeshView {
  std::uint64_t vertex_count = 0;  ///< below 2^32
  std::uint64_t triangle_count = 0;
  std::function<Vec3(std::uint64_t)> position;  ///< of a vertex, metres
  std::function<Triangle(std::uint64_t)> triangle;
  std::span<const Rgb8> colors;                   ///< one a vertex, or none; sRGB
  std::span<const std::array<float, 3>> normals;  ///< one a vertex, or none
  /// Coordinates along an axis differ by this at least, or not at all; 0 if that is not known.
  double least_step = 0;
};

/// Neither mesh nor grid is copied.
[[nodiscard]] MeshView view_of(const ExplicitSurface& surface, const GridLayout& grid);
[[nodiscard]] MeshView view_of(const TriangleMesh& mesh);

struct MeshWriteOptions {
  bool no_clobber = false;  ///< an existing file is an error
};

struct MeshWriteReport {
  std::uint64_t bytes = 0;
  std::vector<std::string> losses;  ///< what the format does not keep, for people
};

/// The extensions that write_mesh_file() knows: ".obj, .off, .ply, .stl".
inline constexpr const char* kMeshWriterExtensions = ".obj, .off, .ply, .stl";

/// Whether the extension of `path` is one of them, any case.
[[nodiscard]] bool is_writable_mesh(const std::string& path);

/// Writes a mesh; the format follows the extension. The same mesh gives the same bytes.
/// - OBJ: numbers as text, the shortest that give the same double precision again; colors of vertices after
///   positions, as many programs have them, from 0 to 1; normals
/// - OFF: the same numbers; colors make it a COFF; no normals
/// - PLY: binary, little-endian; positions in double and normals in single precision, colors of 8 bits
/// - STL: binary; positions in single precision, no colors, normals of triangles. Refused (kLimit) if
///   vertices at different places are at one place then.
/// The file appears whole or not at all. Errors: kUsage (another extension), kLimit (as said; over 2^32 - 1
/// triangles of STL), kOutput, kCancelled.
[[nodiscard]] Status write_mesh_file(const MeshView& mesh, const std::string& path,
                                     const MeshWriteOptions& options = {}, MeshWriteReport* report = nullptr,
                                     const Progress* progress = nullptr);

}  // namespace mesocell
