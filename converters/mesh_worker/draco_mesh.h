#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "converters/import/read_notes.h"
#include "format/result.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// Values of an attribute at all points: as they are, if they are floats, else whole numbers.
struct DracoValues {
  std::vector<std::array<double, 4>> values;  ///< one a point; missing components are 0
  int components = 0;
  double full = 1;  ///< the greatest value of its type; 1 of floats
};

struct DracoMesh {
  std::uint32_t points = 0;
  std::vector<Triangle> triangles;      ///< of points
  std::vector<DracoValues> attributes;  ///< in the order asked for
  ReadNotes notes;                      ///< of attributes that are neither, where none were asked for
};

/// What is wanted of a stream: attributes by their unique ids, or, with an empty list, position and color;
/// the second is then empty if there is none.
/// Errors: kInvalidInput.
[[nodiscard]] Result<DracoMesh> decode_draco(std::span<const std::byte> bytes,
                                             std::span<const std::uint32_t> ids);

}  // namespace mesocell
