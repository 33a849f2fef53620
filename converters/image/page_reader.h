#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "converters/image/image_reader.h"
#include "format/result.h"

namespace mesocell {

/// What a picture's file says of its pages, which are all alike.
struct PageHeader {
  std::uint32_t width = 0, height = 0;
  std::vector<std::string> channels;  ///< their names: "R", "G", "B", "A", "Y"
  bool is_float = false;
  std::uint32_t bits = 0;  ///< of an integer in the file: 8, 16 or 32, its sign not counted; 0 of a float
  ImageEncoding encoding = ImageEncoding::kLinear;
  bool exact = false;  ///< values are those that were stored, not what a lossy compression left of them
};

/// Samples of a page, rows from the top, channels interleaved: integers as they are in the file, or floats.
using PageSamples = std::span<const std::uint32_t>;
[[nodiscard]] inline float float_sample(std::uint32_t sample) { return std::bit_cast<float>(sample); }

/// Who takes the pages: `begin` once before any memory of their size is taken, `take` for each in order. An
/// error of theirs ends the reading.
struct PageSink {
  std::function<Status(const PageHeader&)> begin;
  std::function<Status(std::uint32_t page, PageSamples samples)> take;
  /// Whether integers are wanted as floats of the same value, exact to 24 bits; only then may they be
  /// negative.
  bool as_floats = false;
  /// Whether the first page is all that is wanted, whatever comes after it; `page_count` is then 1 (assert).
  bool first_only = false;
};

/// Reads a picture with samples as they are in the file. `format` is the image library's name for what the
/// file was found to be: "png", "tiff", "openexr", "hdr" or "jpeg"; no other is tried. It must have
/// `page_count` pages or parts, unless the sink wants the first alone. Untrusted input: safe for a TIFF only after check_tiff(); the decoders are
/// those of the image library. Errors: kUnreadable (the image module cannot be loaded), kInvalidInput, kLimit
/// (no memory, large tiles), the sink's.
[[nodiscard]] Status read_pages(const std::string& path, const char* format, std::uint32_t page_count,
                                const PageSink& sink);

}  // namespace mesocell
