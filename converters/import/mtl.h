#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sdk/core/vec.h"

namespace mesocell {

/// What is taken of a material of an OBJ [Alias/Wavefront, MTL]: Kd, in linear light, and map_Kd.
struct MtlMaterial {
  std::string name;
  Vec3 diffuse{1, 1, 1};    ///< 0 to 1
  std::string diffuse_map;  ///< as the file names it; empty: none
  // What is passed over.
  bool has_alpha = false, has_map_options = false, has_more = false;
};

/// Parses an MTL file. Untrusted input: safe. What is not understood is passed over, as are options of
/// map_Kd; the first of two materials of one name counts.
[[nodiscard]] std::vector<MtlMaterial> parse_mtl(std::string_view bytes);

}  // namespace mesocell
