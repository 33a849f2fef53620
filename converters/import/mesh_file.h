#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "converters/import/mesh_warning.h"
#include "converters/import/painted_mesh.h"
#include "converters/import/read_notes.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

struct MeshReadOptions {
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;  ///< larger files are refused (kLimit)
  /// A picture that colors the mesh by its texture coordinates, instead of its materials; empty: they do.
  /// Where there are no coordinates it is kUsage. Only read_painted_mesh() looks at it.
  std::string texture = {};
};

/// What was found in a mesh file.
struct MeshReadReport {
  std::string format;  ///< what its content is: "OBJ", "OFF", "PLY", "STL", "glTF", "GLB" or "Draco"
  std::uint64_t file_bytes = 0;
  std::uint64_t polygons = 0;       ///< faces as the file has them
  std::uint64_t dropped_faces = 0;  ///< triangles left out because two of their corners are the same vertex
  bool vertex_colors = false;       ///< whether the file has colors of vertices
  std::vector<MeshWarning> warnings;
  ReadNotes notes;
};

/// The extensions that read_mesh_file() knows, for messages and help texts.
inline constexpr const char* kMeshExtensions = ".obj, .off, .ply, .stl, .gltf, .glb, .drc";

/// Whether the extension of `path` is one that read_mesh_file() knows.
[[nodiscard]] bool is_readable_mesh(const std::string& path);

/// Reads a triangle mesh with all that colors it; the format follows the content, and the extension, any
/// case, where that does not tell. Polygons are cut into fans. Vertices are kept as they are in the file,
/// also those no face uses; corners of an STL are merged where they are equal. Positions have double
/// precision in OBJ, OFF and PLY and single precision in others; units are the file's. A glTF is one mesh of
/// all that its default scene shows (else the first, else all roots), each part where its nodes, and
/// instances in them (EXT_mesh_gpu_instancing), place it;
/// glTF and Draco are read by mesocell_mesh_worker.
///
/// Colors of vertices and faces are taken as sRGB: properties red, green, blue (or diffuse_red, …) of a PLY,
/// three numbers after the position in an OBJ, and a COFF's, or those after the corners of its faces. The
/// full value is 1 in OBJ and of floating point, 65535 of ushort in PLY, and 255 of all other integers. An
/// OFF has integers if no channel is written with a point or an exponent and one is above 1. Channels beyond
/// the full value are held to it. A vertex or face whose color is missing or not a number is white if others
/// have colors. Where vertices have colors, those of faces are not taken. Alpha is passed over. COLOR_0 of a
/// glTF is linear light.
///
/// Materials: Kd and map_Kd of an OBJ's MTL, a PLY's TextureFile with texture coordinates of faces or
/// vertices, base color and its texture of a glTF. Pictures may be PNG, JPEG, BMP or TGA, those of OBJ and
/// PLY also TIFF, EXR and HDR, of which the first page or part is taken; they are told by their content. What
/// is missing is a warning.
///
/// Untrusted input: safe. Memory is at most a small multiple of the size of the file and of those that it
/// names. Errors, all with a remedy: kUnreadable, kInvalidInput (not a mesh, counts beyond the file's end,
/// index out of range, no triangles, a corner that is not finite), kLimit, kCancelled, kOutput (the worker is
/// not there).
[[nodiscard]] Result<PaintedMesh> read_painted_mesh(const std::string& path,
                                                    const MeshReadOptions& options = {},
                                                    MeshReadReport* report = nullptr,
                                                    const Progress* progress = nullptr);

/// The same without materials, whose files are not looked for: triangles and colors of vertices.
[[nodiscard]] Result<TriangleMesh> read_mesh_file(const std::string& path,
                                                  const MeshReadOptions& options = {},
                                                  MeshReadReport* report = nullptr,
                                                  const Progress* progress = nullptr);

}  // namespace mesocell
