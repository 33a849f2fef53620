#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "converters/image/page_reader.h"
#include "format/result.h"

namespace mesocell {

/// Whether a file begins as a DirectDraw Surface.
[[nodiscard]] bool is_dds(std::string_view head);

/// What the header of a DirectDraw Surface says, of those kinds that are read: not compressed, 8 bits a
/// channel.
struct DdsLayout {
  std::uint32_t width = 0, height = 0, depth = 1;
  std::uint32_t pixel_bytes = 1;
  std::vector<std::uint32_t> shifts;           ///< of the channels that are there: one of gray, or R, G, B
  bool has_levels = false, has_alpha = false;  ///< which are passed over
};

/// Parses the 128 bytes of a header. Untrusted input: safe. Errors: kInvalidInput (none, compressed, another
/// kind of pixels, a cube map).
[[nodiscard]] Result<DdsLayout> parse_dds_header(std::string_view header);

/// Reads the slices of a volume texture, or a picture as one, as read_pages() does those of a TIFF; levels of
/// detail after the first are passed over. Untrusted input: safe. Errors: kUnreadable, kInvalidInput, kLimit
/// (over `max_file_bytes`), the sink's.
[[nodiscard]] Status read_dds_pages(const std::string& path, std::uint64_t max_file_bytes,
                                    const PageSink& sink);

}  // namespace mesocell
