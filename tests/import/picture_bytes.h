#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Pictures for tests, made byte by byte, so that readers are checked against the formats and not against a
/// writer.
namespace mesocell::test {

/// A picture of whole numbers: rows from the top, channels interleaved.
struct PlainPicture {
  std::uint32_t width = 0, height = 0, channels = 1;
  std::vector<std::uint32_t> samples;
};

/// Red, green / blue, white.
inline const PlainPicture kFour{2, 2, 3, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}};

struct PngOptions {
  unsigned bits = 8;  ///< of a sample: 1, 2, 4, 8 or 16
  std::optional<unsigned> color_type =
      std::nullopt;                        ///< else gray, gray with alpha, RGB or RGBA by the channels
  std::vector<std::uint8_t> palette = {};  ///< three bytes a color
  std::uint32_t gamma = 0;                 ///< × 100 000; 0: none is given
};
[[nodiscard]] std::string png_bytes(const PlainPicture& picture, const PngOptions& options = {});

/// How a TIFF is written. Pages are written each before its directory, so that the file ends with a
/// directory.
struct TiffOptions {
  bool big_endian = false, big_tiff = false;
  unsigned bits = 8, format = 1;     ///< of a sample; format 1 unsigned, 2 signed, 3 float
  unsigned compression = 1;          ///< 1 none; of literals alone: 5 LZW, 8 deflate, 32773 PackBits
  std::uint32_t rows_per_strip = 0;  ///< 0: all
  std::uint32_t tile = 0;            ///< edge of a tile; 0: strips
  bool separate = false;             ///< a plane for each channel
  std::optional<unsigned> photometric = std::nullopt;
  /// Tags of short values, which replace those that the writer would write or, if without values, remove
  /// them.
  std::vector<std::pair<unsigned, std::vector<std::uint32_t>>> tags = {};
};
[[nodiscard]] std::string tiff_bytes(const std::vector<PlainPicture>& pages, const TiffOptions& options = {});

/// A Radiance picture of pixels (r, g, b, exponent), not compressed.
[[nodiscard]] std::string hdr_bytes(const PlainPicture& rgbe);

}  // namespace mesocell::test
