#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "converters/import/mesh_warning.h"
#include "converters/import/read_notes.h"
#include "format/result.h"

namespace mesocell {

/// Gives the bytes of a file that a glTF names by a relative URI. Errors: the reader's.
using ResourceReader = std::function<Result<std::vector<std::byte>>(const std::string& uri)>;

/// Checks a glTF 2.0 in full and makes a GLB of it that says the same of meshes and their base colors, and
/// nothing else: one buffer with all data and pictures, one scene. tinygltf runs over the ends of arrays
/// where indices of a file are wrong; here all are right, as are ranges of views and accessors, types of
/// attributes and the tree of nodes. Draco's data are checked by who decodes them.
/// - `json`: the text; `binary`: the second chunk of a GLB, or nothing
/// - extensions that are required and not known are refused by name
/// - remarks on what is passed over are added to `warnings`, and its names to `notes`
/// Untrusted input: safe. Errors: kInvalidInput with the place in the file, kLimit.
[[nodiscard]] Result<std::vector<std::byte>> normalize_gltf(std::string_view json,
                                                            std::span<const std::byte> binary,
                                                            const ResourceReader& read,
                                                            std::vector<MeshWarning>& warnings,
                                                            ReadNotes& notes);

}  // namespace mesocell
