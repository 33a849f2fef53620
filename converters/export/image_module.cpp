#include "converters/export/image_module.h"

#include <cstring>
#include <exception>
#include <memory>
#include <string>

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
  if (message_bytes > 0) {
    std::strncpy(message, error.c_str(), message_bytes - 1);
    message[message_bytes - 1] = 0;
  }
  return 1;
}
}
