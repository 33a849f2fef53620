#pragma once

#include <string>

namespace mesocell {

/// A remark on a file that was read all the same. `id` stays the same from version to version: "renamed".
struct MeshWarning {
  std::string id, text;
};

}  // namespace mesocell
