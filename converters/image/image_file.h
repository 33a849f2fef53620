#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "format/result.h"

namespace mesocell {

/// A picture in memory: rows from the top, channels interleaved, linear light.
struct ImageView {
  std::uint32_t width = 0, height = 0;
  std::span<const std::string> channels;  ///< their names: "R", "G", "B", "A", "Y", "Z"
  std::span<const float> pixels;          ///< width × height × channels.size()
};

struct ImageWriteOptions {
  bool no_clobber = false;  ///< an existing file is an error
};

/// Whether the extension of `path` is one that write_image_file() knows: .png or .exr, any case. Ask this
/// before rendering. Errors: kUsage.
[[nodiscard]] Status check_image_path(const std::string& path);

/// Writes a picture through a temporary name. The same picture gives the same bytes.
/// - .png: 8 bits a channel, sRGB, values clamped to [0, 1], alpha unassociated; 1 to 4 channels.
/// - .exr: 32-bit float, lossless (zip), values as they are, also infinities.
/// The image library is loaded on first use from a module beside the program or in MESOCELL_MODULE_PATH.
/// Errors: kUsage (extension), kOutput (also if the module cannot be loaded), kLimit (no memory).
/// `pixels` must have the size given above (assert).
[[nodiscard]] Status write_image_file(const std::string& path, const ImageView& image,
                                      const ImageWriteOptions& options = {});

}  // namespace mesocell
