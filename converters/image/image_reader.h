#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"

namespace mesocell {

/// What the values of a picture stand for.
enum class ImageEncoding : std::uint8_t {
  kLinear,  ///< light
  kSrgb,    ///< light, as in sRGB [IEC 61966-2-1]; alpha is linear
};

/// A picture that was read: rows from the top, channels interleaved. Integers are scaled to 0…1.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::string> channels;  ///< their names: "R", "G", "B", "A", "Y", "Z", "depth.Z"
  std::vector<float> pixels;          ///< width × height × channels.size()
  ImageEncoding encoding = ImageEncoding::kLinear;
};

struct ImageReadLimits {
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;
  std::uint64_t max_pixel_bytes = std::uint64_t{1} << 32;  ///< of Image::pixels
  std::uint32_t max_channels = 64;
};

/// The extensions that are read, for messages.
inline constexpr const char* kReadableImages = ".png, .exr, .hdr";

/// Whether the extension of `path` is one that read_image_file() knows, any case.
[[nodiscard]] bool is_readable_image(const std::string& path);

/// Reads a picture; its first part if it has several. The format follows the extension, no other is tried.
/// Untrusted input: sizes are checked against `limits` before memory is taken; the decoders are those of the
/// image library. Errors: kUsage (extension), kUnreadable (also if the image module cannot be loaded),
/// kInvalidInput, kLimit.
[[nodiscard]] Result<Image> read_image_file(const std::string& path, const ImageReadLimits& limits = {});

/// Index of a channel by its name.
[[nodiscard]] std::optional<std::size_t> find_channel(const Image& image, std::string_view name);

/// Turns values in sRGB to linear light, in place.
void to_linear(Image& image);

}  // namespace mesocell
