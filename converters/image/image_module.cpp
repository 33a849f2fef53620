#include "converters/image/image_module.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#pragma GCC diagnostic pop

namespace {

/// Puts the picture's file into `bytes`. Empty if that was done.
std::string encode(const MesocellImage& image, std::vector<unsigned char>& bytes) {
  using namespace OIIO;
  Filesystem::IOVecOutput memory(bytes);
  std::unique_ptr<ImageOutput> output = ImageOutput::create(image.format);
  if (!output) return geterror();
  if (!output->set_ioproxy(&memory)) return "this version of OpenImageIO cannot write it to memory";
  const bool integers = image.type == kMesocellPixelUint8;
  ImageSpec spec(int(image.width), int(image.height), int(image.channel_count),
                 integers ? TypeDesc::UINT8 : TypeDesc::FLOAT);
  spec.channelnames.assign(image.channel_names, image.channel_names + image.channel_count);
  spec.alpha_channel = spec.z_channel = -1;
  for (int c = 0; c < spec.nchannels; ++c) {
    if (spec.channelnames[std::size_t(c)] == "A") spec.alpha_channel = c;
    if (spec.channelnames[std::size_t(c)] == "Z") spec.z_channel = c;
  }
  if (integers) {
    spec["oiio:ColorSpace"] = "sRGB";
    spec["oiio:UnassociatedAlpha"] = 1;
  } else {
    spec["compression"] = "zip";
    // Left to itself the library writes the time of day.
    spec["DateTime"] = "";
  }
  if (!output->open(image.format, spec)) return output->geterror();
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
  return !spec.format.is_floating_point() &&
         !OIIO::Strutil::iequals(spec.get_string_attribute("oiio:ColorSpace"), "linear");
}

/// A picture that was opened for reading, or an error's text.
struct OpenedPicture {
  std::unique_ptr<OIIO::ImageInput> input;
  OIIO::ImageSpec spec;
  std::string error;
};

OpenedPicture open_picture(const char* path, const char* format) {
  using namespace OIIO;
  // The caller's limit decides, not the library's.
  attribute("limits:imagesize_MB", 0);
  attribute("limits:channels", 0);
  // Its own threads pass over damaged strips.
  attribute("tiff:multithread", 0);
  OpenedPicture picture;
  const auto failed = [&](const std::string& text) {
    picture.input.reset();
    picture.error = text;
  };
  picture.input = ImageInput::create(format);
  if (!picture.input) {
    failed(geterror());
    return picture;
  }
  ImageSpec wishes;
  ImageSpec& spec = picture.spec;
  wishes["oiio:UnassociatedAlpha"] = 1;
  if (!picture.input->open(path, spec, wishes))
    failed(picture.input->geterror());
  else if (spec.deep || spec.depth > 1)
    failed("it is not a flat picture");
  else if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
    failed("it has no pixels");
  else if (spec.channelnames.size() != std::size_t(spec.nchannels))
    failed("channels have no names");
  return picture;
}

/// Tiles are decoded whole, whatever the size of the picture.
bool tiles_fit(const OIIO::ImageSpec& spec, uint64_t max_bytes) {
  // The factors are at most 2^31 each.
  const uint64_t pixels = uint64_t(std::max(spec.tile_width, 1)) * uint64_t(std::max(spec.tile_height, 1));
  return spec.tile_depth <= 1 && pixels <= max_bytes / sizeof(float) / uint64_t(spec.nchannels);
}

std::vector<const char*> channel_names(const OIIO::ImageSpec& spec) {
  std::vector<const char*> names;
  for (const std::string& name : spec.channelnames) names.push_back(name.c_str());
  return names;
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
  const auto [input, spec, open_error] = open_picture(request.path, request.format);
  if (!input) return failed(open_error);
  if (!tiles_fit(spec, request.max_bytes)) return kMesocellReadRefused;
  const std::vector<const char*> names = channel_names(spec);
  const MesocellImageHeader header{uint32_t(spec.width), uint32_t(spec.height), uint32_t(spec.nchannels),
                                   is_srgb(spec) ? 1u : 0u, names.data()};
  float* pixels = request.make_room(request.context, &header);
  if (!pixels) return kMesocellReadRefused;
  if (!input->read_image(0, 0, 0, spec.nchannels, TypeDesc::FLOAT, pixels)) return failed(input->geterror());
  return input->close() ? kMesocellReadDone : failed(input->geterror());
}

/// Whether the values that are read are those that were stored.
bool is_exact(const OIIO::ImageSpec& spec, std::string_view format) {
  // Read as floats, integers among the channels would be scaled.
  for (const OIIO::TypeDesc& type : spec.channelformats)
    if (!type.is_floating_point()) return false;
  if (format != "openexr") return format != "hdr" && format != "jpeg";
  const std::string compression(spec.get_string_attribute("compression"));
  for (const char* lossless : {"none", "rle", "zip", "zips", "piz"})
    if (compression == lossless) return true;
  return false;
}

/// Reads a page in its own type, which all its channels share.
bool read_native_page(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, int page, char* pixels) {
  if (spec.tile_width > 0)
    return input.read_tiles(page, 0, spec.x, spec.x + spec.width, spec.y, spec.y + spec.height, spec.z,
                            spec.z + 1, 0, spec.nchannels, spec.format, pixels);
  // One row at a time: the library reports no damage of a TIFF's strip if it reads that as a whole.
  for (int y = spec.y; y < spec.y + spec.height; ++y, pixels += spec.scanline_bytes(true))
    if (!input.read_native_scanline(page, 0, y, spec.z, pixels)) return false;
  return true;
}

/// Widens integers to uint32_t; false if one is negative.
template <typename T>
bool widen(const std::vector<char>& from, uint32_t* to) {
  for (std::size_t i = 0; i < from.size() / sizeof(T); ++i) {
    T value;
    std::memcpy(&value, from.data() + i * sizeof(T), sizeof(T));
    if (std::is_signed_v<T> && value < T(0)) return false;
    to[i] = uint32_t(value);
  }
  return true;
}

template <typename T>
void to_floats(const std::vector<char>& from, float* to) {
  for (std::size_t i = 0; i < from.size() / sizeof(T); ++i) {
    T value;
    std::memcpy(&value, from.data() + i * sizeof(T), sizeof(T));
    to[i] = float(value);
  }
}

/// Integers as floats of the same value: the library's own conversion scales them.
void to_floats_as(OIIO::TypeDesc type, const std::vector<char>& from, float* to) {
  using OIIO::TypeDesc;
  switch (type.basetype) {
    case TypeDesc::UINT8:
      return to_floats<uint8_t>(from, to);
    case TypeDesc::INT8:
      return to_floats<int8_t>(from, to);
    case TypeDesc::UINT16:
      return to_floats<uint16_t>(from, to);
    case TypeDesc::INT16:
      return to_floats<int16_t>(from, to);
    case TypeDesc::UINT32:
      return to_floats<uint32_t>(from, to);
    default:
      return to_floats<int32_t>(from, to);
  }
}

bool widen_as(OIIO::TypeDesc type, const std::vector<char>& from, uint32_t* to) {
  using OIIO::TypeDesc;
  switch (type.basetype) {
    case TypeDesc::UINT8:
      return widen<uint8_t>(from, to);
    case TypeDesc::INT8:
      return widen<int8_t>(from, to);
    case TypeDesc::UINT16:
      return widen<uint16_t>(from, to);
    case TypeDesc::INT16:
      return widen<int16_t>(from, to);
    case TypeDesc::UINT32:
      return widen<uint32_t>(from, to);
    default:
      return widen<int32_t>(from, to);
  }
}

bool pages_alike(const OIIO::ImageSpec& a, const OIIO::ImageSpec& b) {
  return a.width == b.width && a.height == b.height && a.depth == b.depth &&
         a.channelnames == b.channelnames && a.format == b.format && a.channelformats == b.channelformats &&
         b.tile_depth <= 1 && !b.deep && is_srgb(a) == is_srgb(b);
}

struct PagesRequest {
  const char* path;
  const char* format;
  uint32_t page_count;
  uint64_t max_bytes;
  const MesocellPageReader* reader;
};

MesocellReadStatus read_pages(const PagesRequest& request, std::string& error) {
  using namespace OIIO;
  const auto failed = [&](const std::string& text) {
    error = text;
    return kMesocellReadFailed;
  };
  const auto [input, first, open_error] = open_picture(request.path, request.format);
  if (!input) return failed(open_error);
  if (!tiles_fit(first, request.max_bytes)) return kMesocellReadRefused;
  const TypeDesc stored = first.format;
  const bool mixed = !first.channelformats.empty(), is_float = mixed || stored.is_floating_point();
  const bool as_floats = request.reader->as_floats != 0;
  if (!is_float && stored.size() > sizeof(uint32_t)) return failed("its integers have more than 32 bits");
  if (input->seek_subimage(int(request.page_count), 0))
    return failed("it has more than " + std::to_string(request.page_count) + " pages or parts");
  (void)input->geterror();
  const std::vector<const char*> names = channel_names(first);
  const MesocellPagesHeader header{uint32_t(first.width),
                                   uint32_t(first.height),
                                   uint32_t(first.nchannels),
                                   is_float || as_floats ? kMesocellSampleFloat : kMesocellSampleUint,
                                   is_float ? 0u : uint32_t(8 * stored.size()) - uint32_t(stored.is_signed()),
                                   is_srgb(first) ? 1u : 0u,
                                   is_exact(first, request.format) ? 1u : 0u,
                                   names.data()};
  void* room = request.reader->make_room(request.reader->context, &header);
  if (!room) return kMesocellReadRefused;
  const uint64_t samples = uint64_t(header.width) * header.height * header.channel_count;
  std::vector<char> native(mixed ? 0 : samples * stored.size());
  for (uint32_t page = 0; page < request.page_count; ++page) {
    const auto page_failed = [&](const std::string& text) {
      return failed(request.page_count == 1 ? text : "page " + std::to_string(page + 1) + ": " + text);
    };
    if (!input->seek_subimage(int(page), 0)) return page_failed("it cannot be found, " + input->geterror());
    const ImageSpec spec = input->spec();
    if (!pages_alike(first, spec) || !tiles_fit(spec, request.max_bytes))
      return page_failed("it is not of the size or type of the first");
    if (mixed ? !input->read_image(int(page), 0, 0, spec.nchannels, TypeDesc::FLOAT, room)
              : !read_native_page(*input, spec, int(page), native.data()))
      return page_failed(input->geterror());
    if (is_float && !mixed && !convert_types(stored, native.data(), TypeDesc::FLOAT, room, int(samples)))
      return page_failed("its kind of floats is not known");
    if (!is_float && as_floats)
      to_floats_as(stored, native, static_cast<float*>(room));
    else if (!is_float && !widen_as(stored, native, static_cast<uint32_t*>(room)))
      return page_failed("a value is negative");
    if (request.reader->take(request.reader->context, page) != 0) return kMesocellReadRefused;
  }
  return input->close() ? kMesocellReadDone : failed(input->geterror());
}

void copy_message(const std::string& text, char* message, size_t message_bytes) {
  if (message_bytes == 0) return;
  std::strncpy(message, text.c_str(), message_bytes - 1);
  message[message_bytes - 1] = 0;
}

/// Runs `body` for a function of the C interface: it may throw, and leaves the error's text.
template <typename Body>
int guarded(char* message, size_t message_bytes, const Body& body) {
  std::string error;
  int status = kMesocellReadFailed;
  static_assert(kMesocellReadFailed == 1, "what a failed writing returns as well");
  try {
    status = body(error);
  } catch (const std::exception& exception) {
    error = exception.what();
  } catch (...) {
    error = "unknown error of the image library";
  }
  copy_message(error, message, message_bytes);
  return status;
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) uint32_t mesocell_image_module_version(void) {
  return MESOCELL_IMAGE_MODULE_VERSION;
}

__attribute__((visibility("default"))) int mesocell_encode_image(const MesocellImage* image,
                                                                 MesocellTakeBytes take, void* context,
                                                                 char* message, size_t message_bytes) {
  return guarded(message, message_bytes, [&](std::string& error) {
    std::vector<unsigned char> bytes;
    error = encode(*image, bytes);
    if (!error.empty()) return 1;
    take(context, bytes.data(), bytes.size());
    return 0;
  });
}

__attribute__((visibility("default"))) int mesocell_read_image(const char* path, const char* format,
                                                               uint64_t max_bytes, MesocellMakeRoom make_room,
                                                               void* context, char* message,
                                                               size_t message_bytes) {
  return guarded(message, message_bytes, [&](std::string& error) {
    return int(read({path, format, max_bytes, make_room, context}, error));
  });
}

__attribute__((visibility("default"))) int mesocell_read_pages(const char* path, const char* format,
                                                               uint32_t page_count, uint64_t max_bytes,
                                                               const MesocellPageReader* reader,
                                                               char* message, size_t message_bytes) {
  return guarded(message, message_bytes, [&](std::string& error) {
    return int(read_pages({path, format, page_count, max_bytes, reader}, error));
  });
}
}
