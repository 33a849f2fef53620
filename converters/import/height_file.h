#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "converters/import/read_notes.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// What heights are read from, for messages and help texts.
inline constexpr const char* kHeightSources = ".png, .tif, .tiff, .exr, .hdr, .jpg";

struct HeightReadOptions {
  std::string channel;            ///< its name; empty: the first one
  std::optional<double> no_data;  ///< samples of this value, as stored, are missing
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;
  std::uint64_t max_pixels = std::uint64_t{1} << 28;
};

/// Samples of a picture's channel as they are in the file, not scaled and not turned to linear light.
struct HeightSamples {
  std::uint32_t width = 0, depth = 0;
  std::vector<float> samples;  ///< rows from the top; NaN: missing
  float full = 1;              ///< the greatest value of an integer, 255 or 65535; 1 of floats
  std::string format;          ///< "png", …
  std::string channel;
  bool exact = true;  ///< false: a lossy compression
  ReadNotes notes;
};

/// Reads heights from a picture, whatever its extension. Untrusted input: safe, as far as the decoders of the
/// image library are. Errors: kUnreadable, kInvalidInput (no picture, several pages, damaged), kUsage (no
/// such channel), kLimit, kCancelled.
[[nodiscard]] Result<HeightSamples> read_height_file(const std::string& path,
                                                     const HeightReadOptions& options = {},
                                                     const Progress* progress = nullptr);

}  // namespace mesocell
