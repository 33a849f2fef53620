#include "converters/image/image_reader.h"

#include <array>
#include <cmath>
#include <new>

#include "converters/image/exr_check.h"
#include "converters/image/extension.h"
#include "converters/image/image_module_access.h"
#include "converters/image/input_file.h"

namespace mesocell {
namespace {

struct ReadableFormat {
  std::string_view extension;
  const char* name;  ///< the image library's
};

/// Of pixels; the library takes memory for up to 256 rows before a picture can be refused.
constexpr std::uint32_t kMaxExrSide = 1u << 16;

constexpr std::array<ReadableFormat, 3> kReadableFormats = {
    {{".png", "png"}, {".exr", "openexr"}, {".hdr", "hdr"}}};

const ReadableFormat* find_readable(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const ReadableFormat& format : kReadableFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

struct Room {
  const ImageReadLimits* limits;
  Image image;
  std::string refusal;
};

/// Makes room for the pixels if the limits allow it. No exception may pass through the module.
float* make_room(void* context, const MesocellImageHeader* header) {
  Room& room = *static_cast<Room*>(context);
  try {
    const std::uint64_t pixels = std::uint64_t{header->width} * header->height;
    if (header->channel_count > room.limits->max_channels ||
        pixels > room.limits->max_pixel_bytes / sizeof(float) / header->channel_count) {
      room.refusal = std::to_string(header->width) + " x " + std::to_string(header->height) + " pixels of " +
                     std::to_string(header->channel_count) + " channels are over the limit of " +
                     std::to_string(room.limits->max_pixel_bytes) + " bytes or " +
                     std::to_string(room.limits->max_channels) + " channels; use a smaller picture";
      return nullptr;
    }
    room.image.width = header->width;
    room.image.height = header->height;
    room.image.channels.assign(header->channel_names, header->channel_names + header->channel_count);
    room.image.encoding = header->srgb ? ImageEncoding::kSrgb : ImageEncoding::kLinear;
    room.image.pixels.resize(std::size_t(pixels) * header->channel_count);
    return room.image.pixels.data();
  } catch (const std::exception&) {
    return nullptr;
  }
}

float decode_srgb(float encoded) {
  const double x = encoded;
  return float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

}  // namespace

bool is_readable_image(const std::string& path) { return find_readable(path) != nullptr; }

Result<Image> read_image_file(const std::string& path, const ImageReadLimits& limits) {
  const ReadableFormat* format = find_readable(path);
  if (!format)
    return Error{
        ErrorCode::kUsage,
        std::string("its extension is not one of a picture that can be read; use ") + kReadableImages};
  // The library's words for a file that is not there are not ours, and it would wait for a pipe.
  const Result<InputFile> file = InputFile::open(path, limits.max_file_bytes);
  if (!file) return file.error();
  if (format->extension == ".exr")
    if (Status status = check_exr(*file, kMaxExrSide); !status) return status.error();
  const Result<ImageModule>& module = image_module();
  if (!module) return Error{ErrorCode::kUnreadable, module.error().message};
  Room room{&limits, {}, "there is not enough memory to read the picture; use a smaller one"};
  std::array<char, 512> message{};
  const int status = module->read(path.c_str(), format->name, limits.max_pixel_bytes, make_room, &room,
                                  message.data(), message.size());
  if (status == kMesocellReadRefused) return Error{ErrorCode::kLimit, room.refusal};
  if (status != kMesocellReadDone)
    return Error{ErrorCode::kInvalidInput, std::string("it cannot be read as ") +
                                               std::string(format->extension) + " (" + message.data() +
                                               "); check that it is whole"};
  return std::move(room.image);
}

std::optional<std::size_t> find_channel(const Image& image, std::string_view name) {
  for (std::size_t c = 0; c < image.channels.size(); ++c)
    if (image.channels[c] == name) return c;
  return std::nullopt;
}

void to_linear(Image& image) {
  if (image.encoding == ImageEncoding::kLinear) return;
  const std::size_t channels = image.channels.size();
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (image.channels[i % channels] != "A") image.pixels[i] = decode_srgb(image.pixels[i]);
  image.encoding = ImageEncoding::kLinear;
}

}  // namespace mesocell
