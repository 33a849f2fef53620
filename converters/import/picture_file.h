#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "format/result.h"

namespace mesocell {

struct PictureLimits {
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;
  std::uint32_t max_pages = 1;    ///< of a TIFF
  std::uint32_t max_side = 1024;  ///< pixels, where the header is checked: TIFF and OpenEXR
};

/// What a picture's file was found to be, whatever its name.
struct PictureFile {
  const char* format = nullptr;  ///< as the image library calls it: "png", "tiff", "openexr", "hdr", "jpeg"
  std::uint32_t pages = 1;
  std::uint32_t stored_bits = 0;  ///< of a gray picture's integers; 0 where the library knows
};

/// The format that a file begins as, as PictureFile::format; null if it is no picture that can be read. 32
/// bytes suffice.
[[nodiscard]] const char* picture_format(std::string_view head);

/// Looks at a picture's file before the image library sees it: directories of TIFF and headers of EXR files
/// are checked in full. Untrusted input: safe. Errors: kUnreadable, kInvalidInput (empty, damaged, no
/// picture: the message says what it is, with a remedy for terrain alone), kLimit.
[[nodiscard]] Result<PictureFile> examine_picture(const std::string& path, const PictureLimits& limits);

}  // namespace mesocell
