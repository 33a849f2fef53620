#pragma once

#include <cstddef>
#include <span>

#include "format/result.h"
#include "sdk/surface/surface_paint.h"

namespace mesocell {

/// Decodes a PNG, JPEG, BMP or TGA by its content; alpha is passed over. `max_texels`: of the picture.
/// Errors: kInvalidInput, kLimit.
[[nodiscard]] Result<TextureImage> decode_picture(std::span<const std::byte> bytes, std::uint64_t max_texels);

}  // namespace mesocell
