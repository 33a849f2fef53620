#include "converters/image/image_module.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <OpenImageIO/imageio.h>
#pragma GCC diagnostic pop

namespace {

/// Empty if the picture was written.
std::string write(const MesocellImage& image) {
  using namespace OIIO;
  std::unique_ptr<ImageOutput> output = ImageOutput::create(image.path);
  if (!output) return geterror();
  const bool bytes = image.type == kMesocellPixelUint8;
  ImageSpec spec(int(image.width), int(image.height), int(image.channel_count),
                 bytes ? TypeDesc::UINT8 : TypeDesc::FLOAT);
  spec.channelnames.assign(image.channel_names, image.channel_names + image.channel_count);
  spec.alpha_channel = spec.z_channel = -1;
  for (int c = 0; c < spec.nchannels; ++c) {
    if (spec.channelnames[std::size_t(c)] == "A") spec.alpha_channel = c;
    if (spec.channelnames[std::size_t(c)] == "Z") spec.z_channel = c;
  }
  if (bytes) {
    spec["oiio:ColorSpace"] = "sRGB";
    spec["oiio:UnassociatedAlpha"] = 1;
  } else {
    spec["compression"] = "zip";
    // Left to itself the library writes the time of day.
    spec["DateTime"] = "";
  }
  if (!output->open(image.path, spec)) return output->geterror();
  if (!output->write_image(spec.format, image.pixels)) {
    const std::string error = output->geterror();
    output->close();
    return error;
  }
  if (!output->close()) return output->geterror();
  return {};
}

/// Whether the values of a file stand for light as in sRGB. Formats of floats are linear.
bool is_srgb(const OIIO::ImageSpec& spec) {
  return !spec.format.is_floating_point() && spec.get_string_attribute("oiio:ColorSpace") != "Linear";
}

struct ReadRequest {
  const char* path;
  const char* format;
  uint64_t max_bytes;
  MesocellMakeRoom make_room;
  void* context;
};

MesocellReadStatus read(const ReadRequest& request, std::string& error) {
  using namespace OIIO;
  const auto failed = [&](const std::string& text) {
    error = text;
    return kMesocellReadFailed;
  };
  // The caller's limit decides, not the library's.
  attribute("limits:imagesize_MB", 0);
  attribute("limits:channels", 0);
  std::unique_ptr<ImageInput> input = ImageInput::create(request.format);
  if (!input) return failed(geterror());
  ImageSpec wishes, spec;
  wishes["oiio:UnassociatedAlpha"] = 1;
  if (!input->open(request.path, spec, wishes)) return failed(input->geterror());
  if (spec.deep || spec.depth > 1) return failed("it is not a flat picture");
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) return failed("it has no pixels");
  if (spec.channelnames.size() != std::size_t(spec.nchannels)) return failed("channels have no names");
  // Tiles are decoded whole, whatever the size of the picture. The factors are at most 2^31 each.
  const uint64_t tile_pixels =
      uint64_t(std::max(spec.tile_width, 1)) * uint64_t(std::max(spec.tile_height, 1));
  if (tile_pixels > request.max_bytes / sizeof(float) / uint64_t(spec.nchannels)) return kMesocellReadRefused;
  std::vector<const char*> names;
  for (const std::string& name : spec.channelnames) names.push_back(name.c_str());
  const MesocellImageHeader header{uint32_t(spec.width), uint32_t(spec.height), uint32_t(spec.nchannels),
                                   is_srgb(spec) ? 1u : 0u, names.data()};
  float* pixels = request.make_room(request.context, &header);
  if (!pixels) return kMesocellReadRefused;
  if (!input->read_image(0, 0, 0, spec.nchannels, TypeDesc::FLOAT, pixels)) return failed(input->geterror());
  return input->close() ? kMesocellReadDone : failed(input->geterror());
}

void copy_message(const std::string& text, char* message, size_t message_bytes) {
  if (message_bytes == 0) return;
  std::strncpy(message, text.c_str(), message_bytes - 1);
  message[message_bytes - 1] = 0;
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) uint32_t mesocell_image_module_version(void) {
  return MESOCELL_IMAGE_MODULE_VERSION;
}

__attribute__((visibility("default"))) int mesocell_write_image(const MesocellImage* image, char* message,
                                                                size_t message_bytes) {
  std::string error;
  try {
    error = write(*image);
    if (error.empty()) return 0;
  } catch (const std::exception& exception) {
    error = exception.what();
  } catch (...) {
    error = "unknown error of the image library";
  }
  copy_message(error, message, message_bytes);
  return 1;
}

__attribute__((visibility("default"))) int mesocell_read_image(const char* path, const char* format,
                                                               uint64_t max_bytes, MesocellMakeRoom make_room,
                                                               void* context, char* message,
                                                               size_t message_bytes) {
  std::string error;
  int status = kMesocellReadFailed;
  try {
    status = read({path, format, max_bytes, make_room, context}, error);
  } catch (const std::exception& exception) {
    error = exception.what();
  } catch (...) {
    error = "unknown error of the image library";
  }
  copy_message(error, message, message_bytes);
  return status;
}
}
