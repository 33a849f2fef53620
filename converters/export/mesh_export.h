#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/surface/explicit_surface.h"

namespace mesocell {

struct MeshExportOptions {
  std::optional<TileBox> tiles;          ///< absent: all; not for instances
  std::uint64_t max_faces = 20'000'000;  ///< faces of voxels that may be written, each two triangles
  SurfaceNormals normals = SurfaceNormals::kNone;
  bool colors = false;  ///< where the object has any
  bool draco = false;   ///< GLB alone
  /// GLB alone: a mesh of each cell, and a place for each INSIDE instance.
  bool instanced = false;
  bool drop_buried = false;  ///< of instances those none of whose voxels' faces is on the surface
  bool no_clobber = false;   ///< an existing file is an error
  unsigned threads = 0;      ///< 0: the machine's; the result does not depend on it
};

struct MeshExportReport {
  std::uint64_t faces = 0;  ///< of voxels, in the file; instanced: of one instance of each cell
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t split_vertices = 0;  ///< more than places of vertices, as the surface is not manifold there
  std::uint64_t instances = 0;       ///< placed, where they are
  std::uint64_t buried = 0;          ///< instances dropped
  std::uint64_t bytes = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< of phases, in order
  std::vector<std::string> losses;                      ///< what is not in the file, for people
};

/// The extensions that write_mesh_export() knows: ".glb, .obj, .off, .ply, .stl".
inline constexpr const char* kMeshExportExtensions = ".glb, .obj, .off, .ply, .stl";

/// Whether the extension of `path` is one of them, any case.
[[nodiscard]] bool is_mesh_export(const std::string& path);

/// Writes the explicit surface of an object, or with `instanced` its instances; the format follows the
/// extension. See make_explicit_surface(), write_mesh_file() and write_gltf() for what is written and for
/// errors, besides which there is kUsage for options that the format does not have.
[[nodiscard]] Status write_mesh_export(const CellObject& object, const std::string& path,
                                       const MeshExportOptions& options = {},
                                       MeshExportReport* report = nullptr,
                                       const Progress* progress = nullptr);

}  // namespace mesocell
