#include "converters/image/image_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <new>
#include <optional>
#include <vector>

#include "converters/image/extension.h"
#include "converters/image/image_module_access.h"
#include "format/file.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

struct ImageFormat {
  std::string_view extension;
  const char* name;
  MesocellPixelType type;
};

constexpr std::array<ImageFormat, 2> kFormats = {
    {{".png", "png", kMesocellPixelUint8}, {".exr", "openexr", kMesocellPixelFloat}}};

const ImageFormat* find_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const ImageFormat& format : kFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

std::uint8_t encode_linear(float value) {
  const double x = value > 0 ? std::min(double{value}, 1.0) : 0.0;
  return std::uint8_t(std::lround(255 * x));
}

/// The pixels as the module takes them for 8-bit files; alpha carries no gamma.
std::vector<std::uint8_t> encode_bytes(const ImageView& image) {
  const std::size_t channels = image.channels.size();
  std::vector<std::uint8_t> bytes(image.pixels.size());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = image.channels[i % channels] == "A" ? encode_linear(image.pixels[i])
                                                   : linear_to_srgb8(image.pixels[i]);
  return bytes;
}

struct Target {
  AtomicFile& file;
  Status status;
};

void write_to_target(void* context, const void* bytes, std::size_t count) {
  Target& target = *static_cast<Target*>(context);
  target.status = target.file.write({static_cast<const std::byte*>(bytes), count});
}

}  // namespace

Status check_image_path(const std::string& path) {
  if (find_format(path)) return {};
  return Error{ErrorCode::kUsage,
               "its extension is not one of a picture that can be written; use .png or .exr"};
}

Status write_image_file(const std::string& path, const ImageView& image, const ImageWriteOptions& options) {
  assert(image.pixels.size() == std::size_t{image.width} * image.height * image.channels.size());
  const ImageFormat* format = find_format(path);
  if (!format) return check_image_path(path);
  const Result<ImageModule>& module = image_module();
  if (!module) return module.error();
  Result<AtomicFile> file = AtomicFile::create(path, options.no_clobber);
  if (!file) return file.error();
  try {
    std::vector<std::uint8_t> bytes;
    if (format->type == kMesocellPixelUint8) bytes = encode_bytes(image);
    std::vector<const char*> names;
    for (const std::string& name : image.channels) names.push_back(name.c_str());
    const MesocellImage picture{format->name,
                                image.width,
                                image.height,
                                std::uint32_t(image.channels.size()),
                                1,
                                format->type,
                                names.data(),
                                bytes.empty() ? static_cast<const void*>(image.pixels.data()) : bytes.data()};
    std::array<char, 512> message{};
    Target target{*file, {}};
    if (module->encode(&picture, write_to_target, &target, message.data(), message.size()) != 0)
      return Error{ErrorCode::kOutput,
                   std::string("the picture could not be encoded (") + message.data() + ")"};
    if (!target.status.ok()) return target.status;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "there is not enough memory to write the picture; make it smaller"};
  }
  return file->commit();
}

}  // namespace mesocell
