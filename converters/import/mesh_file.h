#pragma once

#include <cstdint>
#include <string>

#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

struct MeshReadOptions {
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;  ///< larger files are refused (kLimit)
};

/// What was found in a mesh file.
struct MeshReadReport {
  std::string format;  ///< "OBJ", "OFF", "PLY" or "STL"
  std::uint64_t file_bytes = 0;
  std::uint64_t polygons = 0;       ///< faces as the file has them
  std::uint64_t dropped_faces = 0;  ///< triangles left out because two of their corners are the same vertex
  bool vertex_colors = false;       ///< whether the file has colors of vertices
};

/// The extensions that read_mesh_file() knows, for messages and help texts: ".obj, .off, .ply, .stl".
inline constexpr const char* kMeshExtensions = ".obj, .off, .ply, .stl";

/// Whether the extension of `path` is one that read_mesh_file() knows.
[[nodiscard]] bool is_readable_mesh(const std::string& path);

/// Reads a triangle mesh; the format follows the extension, any case. Polygons are cut into fans. Vertices
/// are kept as they are in the file, also those no face uses; corners of an STL are merged where they are
/// equal. Positions have double precision in OBJ, OFF and PLY and single precision in STL; units are the
/// file's.
///
/// Colors of vertices are taken as sRGB: properties red, green, blue (or diffuse_red, …) of a PLY, three
/// numbers after the position in an OBJ, and a COFF's. The full value is 1 in OBJ and of floating point,
/// 65535 of ushort in PLY, and 255 of all other integers. A COFF has integers if no channel is written with a
/// point or an exponent and one is above 1. Channels beyond the full value are held to it. A vertex whose
/// color is missing or not a number is white if others have colors. Alpha is passed over, and so are colors
/// of faces, as STL has them.
///
/// Untrusted input: safe. Memory is at most a small multiple of the file's size. Errors, all with a
/// remedy: kUsage (unknown extension), kUnreadable, kInvalidInput (not a mesh, counts beyond the file's end,
/// index out of range, no triangles, a corner that is not finite), kLimit, kCancelled.
[[nodiscard]] Result<TriangleMesh> read_mesh_file(const std::string& path,
                                                  const MeshReadOptions& options = {},
                                                  MeshReadReport* report = nullptr,
                                                  const Progress* progress = nullptr);

}  // namespace mesocell
