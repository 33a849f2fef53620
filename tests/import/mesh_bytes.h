#pragma once

#include <string>
#include <vector>

#include "sdk/core/triangle_mesh.h"

/// Mesh files for tests, in memory and in a folder that goes away.
namespace mesocell::test {

struct MeshBytes {
  std::string name;  ///< with the extension
  std::string bytes;
};

/// The mesh in every format and encoding that is read: OBJ, OFF, PLY as text and both binaries, STL as text
/// and binary. Colors of vertices are written in all but STL.
[[nodiscard]] std::vector<MeshBytes> in_all_formats(const TriangleMesh& mesh);
/// One of them, by its name: "mesh.obj", "mesh.off", "text.ply", "little.ply", "big.ply", "text.stl",
/// "binary.stl".
[[nodiscard]] std::string mesh_bytes(const TriangleMesh& mesh, const std::string& name);

/// A folder of its own, removed with all that is in it.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const;
  /// Names of all that is in the folder, in order.
  [[nodiscard]] std::vector<std::string> list() const;

 private:
  std::string path_;
};

[[nodiscard]] std::string read_bytes(const std::string& path);

}  // namespace mesocell::test
