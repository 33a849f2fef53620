#pragma once

#include <cstdint>

#include "converters/image/input_file.h"
#include "format/result.h"

namespace mesocell {

/// What the directory of a TIFF file says of its pages, which are all alike.
struct TiffLayout {
  std::uint32_t pages = 0;
  std::uint32_t bits = 0;  ///< of an integer in a gray picture as it is stored, 1, 2, 4, …; else 0
};

/// Checks the directory of a TIFF file before the image library sees it, which misreads some kinds without a
/// word and takes a chain of pages that is cut off for a shorter one. What passes: gray with black as zero,
/// RGB, either with alpha, palettes; integers of 1, 2, 4, 8, 16 or 32 bits, floats of 16, 32 or 64; strips or
/// tiles, all within the file; no compression, LZW, deflate or PackBits; classic or BigTIFF, either byte
/// order [TIFF 6.0]. Pages must be alike, upright, at most `max_side` pixels wide and high. Untrusted input:
/// safe. Memory: a small multiple of `max_pages`. Errors: kInvalidInput, kLimit, each naming the page.
[[nodiscard]] Result<TiffLayout> check_tiff(const InputFile& file, std::uint32_t max_pages,
                                            std::uint32_t max_side);

}  // namespace mesocell
