#include "converters/mesh_worker/texture_decoder.h"

#include <climits>
#include <cstdlib>
#include <memory>
#include <string>

#include "converters/import/mesh_message.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace mesocell {

Result<TextureImage> decode_picture(std::span<const std::byte> bytes, std::uint64_t max_texels) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  int width = 0, height = 0, channels = 0;
  if (bytes.size() > INT_MAX || !stbi_info_from_memory(data, int(bytes.size()), &width, &height, &channels))
    return Error{ErrorCode::kInvalidInput,
                 "the picture is no PNG, JPEG, BMP or TGA that can be read, or damaged; save it again"};
  if (width <= 0 || height <= 0 || width > int(kMaxTextureSide) || height > int(kMaxTextureSide) ||
      std::uint64_t(width) * std::uint64_t(height) > max_texels)
    return Error{ErrorCode::kLimit, "the picture has " + std::to_string(width) + " x " +
                                        std::to_string(height) +
                                        " pixels, more than are read for a mesh; use a smaller one"};
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, int(bytes.size()), &width, &height, &channels, 3), std::free);
  if (!pixels)
    return Error{ErrorCode::kInvalidInput,
                 std::string("the picture is damaged (") + stbi_failure_reason() + "); save it again"};
  TextureImage image;
  image.width = std::uint32_t(width);
  image.height = std::uint32_t(height);
  image.texels.resize(std::size_t{image.width} * image.height);
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) image.texels[i][k] = pixels.get()[3 * i + k];
  return image;
}

}  // namespace mesocell
