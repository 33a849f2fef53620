#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "converters/import/plain_mesh.h"

namespace mesocell {

enum class MeshKind : std::uint8_t { kObj, kOff, kPly, kStl, kGltf, kGlb, kDraco };

/// One row a format.
struct MeshFormat {
  MeshKind kind;
  std::string_view extension, name;
  /// None for those that mesocell_mesh_worker reads.
  Result<PlainMesh> (*plain)(std::string_view, const Progress*);
};

/// The format that a file's extension stands for, any case; null if none.
[[nodiscard]] const MeshFormat* format_by_extension(const std::string& path);

/// The format that a file's content shows; null if it shows none. `other`: what it is, if it is no mesh, as
/// sniff_content() calls it. Untrusted input: safe.
[[nodiscard]] const MeshFormat* format_by_content(std::string_view bytes, std::string_view& other);

}  // namespace mesocell
