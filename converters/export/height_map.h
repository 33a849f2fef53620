#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

struct HeightMapOptions {
  int axis = 1;                                      ///< seen from its end: 0, 1, 2 for x, y, z
  bool from_low = false;                             ///< from its lower end
  std::optional<std::array<std::uint32_t, 2>> size = std::nullopt;  ///< pixels; else a pixel a voxel
  std::uint64_t max_pixels = std::uint64_t{1} << 26;
  bool no_clobber = false;
  unsigned threads = 0;
};

struct HeightMapReport {
  std::uint32_t width = 0, height = 0;
  std::uint64_t bytes = 0, missing = 0;  ///< missing: pixels at which nothing is hit
  double spacing = 0;                    ///< metres between pixels, along the width
  std::string heights;                   ///< what reads it again as it is: the value of --heights
  std::vector<std::string> losses;
};

/// Writes the heights of an object as seen along an axis from far away, above the object box's side that is
/// farther: exact hits at the pixels' centres. Seen from +y, columns are x and rows z downwards, as heights
/// are read; from other sides the picture is upright: columns x, rows y from the top; from ±x columns are -z
/// or z, from -y rows are -z.
/// - .exr, .tif: floats, metres; not a number where nothing is hit
/// - .png: 16 bits, 0 where nothing is hit, else 1 + 65534 · height / extent, rounded
/// Errors: kUsage, kLimit, kOutput, kCancelled.
[[nodiscard]] Status write_height_map(const CellObject& object, const std::string& path,
                                      const HeightMapOptions& options, HeightMapReport* report = nullptr,
                                      const Progress* progress = nullptr);

}  // namespace mesocell
