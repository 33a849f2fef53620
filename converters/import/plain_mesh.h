#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "converters/import/mesh_warning.h"
#include "converters/import/read_notes.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/core/vec.h"
#include "sdk/surface/surface_paint.h"

/// OpenMesh's readers trust their input: they hang on a PLY header without an end, abort on odd OBJ faces,
/// open any file that an OBJ names as its material, drop vertices that are no numbers so that all later
/// indices shift, do not know comments in OFF, and deliver single precision. So every file is first checked
/// in full and brought into the plain part of its format that the library reads well; the positions are kept
/// in double precision meanwhile, and the colors as they are.
namespace mesocell {

/// A checked mesh, ready for the library.
struct PlainMesh {
  std::string extension;        ///< which of the library's readers: "obj", "off", "ply" or "stl"
  bool binary = false;          ///< for STL: which of its two encodings
  std::string bytes;            ///< the file in plain form: vertices and triangles, no more
  std::vector<Vec3> positions;  ///< as in the file, may be non-finite; empty for STL
  std::vector<Rgb8> colors;     ///< one a vertex, or empty: the file has none
  std::uint64_t triangles = 0;  ///< that the library must deliver
  std::uint64_t polygons = 0;
  std::uint64_t dropped_faces = 0;
  /// Without materials and pictures, which stand in other files.
  SurfacePaint paint;
  std::vector<std::string> material_files;  ///< of an OBJ, as it names them
  std::vector<std::string>
      materials;  ///< by SurfacePaint::material_indices: names in those files, or pictures
  std::vector<MeshWarning> warnings;
  ReadNotes notes;
};

/// Brings an array of one entry a triangle to `count`, where the first triangles of a file have none.
template <typename T>
void fill_up(std::vector<T>& array, std::uint64_t count, const T& with) {
  array.resize(std::size_t(count), with);
}

/// Check a file's bytes and bring them into plain form. Untrusted input: safe. Counts are compared with the
/// size of `bytes` before anything is allocated. Errors: kInvalidInput with the line or face, kCancelled.
[[nodiscard]] Result<PlainMesh> plain_obj(std::string_view bytes, const Progress* progress);
[[nodiscard]] Result<PlainMesh> plain_off(std::string_view bytes, const Progress* progress);
[[nodiscard]] Result<PlainMesh> plain_ply(std::string_view bytes, const Progress* progress);
[[nodiscard]] Result<PlainMesh> plain_stl(std::string_view bytes, const Progress* progress);

/// Whether a file is a binary STL by its size, and whether it begins as a text STL does.
[[nodiscard]] bool is_binary_stl(std::string_view bytes);
[[nodiscard]] bool is_text_stl(std::string_view bytes);

}  // namespace mesocell
