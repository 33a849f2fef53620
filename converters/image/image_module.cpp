#include "converters/image/image_module.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
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

OIIO::TypeDesc stored_type(MesocellPixelType type) {
  using OIIO::TypeDesc;
  switch (type) {
    case kMesocellPixelUint8:
    case kMesocellPixelData8:
      return TypeDesc::UINT8;
    case kMesocellPixelData16:
      return TypeDesc::UINT16;
    case kMesocellPixelData32:
      return TypeDesc::UINT32;
    default:
      return TypeDesc::FLOAT;
  }
}

OIIO::ImageSpec page_spec(const MesocellImage& image, uint32_t page) {
  using namespace OIIO;
  ImageSpec spec(int(image.width), int(image.height), int(image.channel_count), stored_type(image.type));
  spec.channelnames.assign(image.channel_names, image.channel_names + image.channel_count);
  spec.alpha_channel = spec.z_channel = -1;
  for (int c = 0; c < spec.nchannels; ++c) {
    if (spec.channelnames[std::size_t(c)] == "A") spec.alpha_channel = c;
    if (spec.channelnames[std::size_t(c)] == "Z") spec.z_channel = c;
  }
  if (image.type == kMesocellPixelUint8) {
    spec["oiio:ColorSpace"] = "sRGB";
    spec["oiio:UnassociatedAlpha"] = 1;
  }
  if (std::string_view(image.format) != "png") {
    spec["compression"] = "zip";
    // Left to itself the library writes the time of day.
    spec["DateTime"] = "";
  }
  if (image.page_count > 1) spec["oiio:subimagename"] = std::to_string(page);
  return spec;
}

const void* page_pixels(const MesocellImage& image, const OIIO::ImageSpec& spec, uint32_t page) {
  return static_cast<const char*>(image.pixels) + std::size_t{page} * std::size_t(spec.image_bytes(true));
}

/// Writes the pages; `name` is a file's if the library writes to one. Empty if that was done.
std::string write_pages(OIIO::ImageOutput& output, const MesocellImage& image, const std::string& name) {
  using namespace OIIO;
  std::vector<ImageSpec> specs;
  for (uint32_t page = 0; page < image.page_count; ++page) specs.push_back(page_spec(image, page));
  // Parts of an OpenEXR file are made known at once, pages of a TIFF one by one.
  const bool at_once = image.page_count > 1 && !output.supports("appendsubimage");
  if (at_once && !output.open(name, int(image.page_count), specs.data())) return output.geterror();
  for (uint32_t page = 0; page < image.page_count; ++page) {
    const ImageSpec& spec = specs[page];
    const auto mode = page == 0 ? ImageOutput::Create : ImageOutput::AppendSubimage;
    if (!(at_once && page == 0) && !output.open(name, spec, mode)) return output.geterror();
    if (!output.write_image(spec.format, page_pixels(image, spec, page))) {
      const std::string error = output.geterror();
      output.close();
      return error;
    }
  }
  if (!output.close()) return output.geterror();
  return {};
}

/// A file without a name, for what the library cannot write to memory.
class ScratchFile {
 public:
  ScratchFile() {
    name_ = (std::filesystem::temp_directory_path() / "mesocell-XXXXXX").string();
    descriptor_ = mkstemp(name_.data());
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() {
    if (descriptor_ < 0) return;
    close(descriptor_);
    unlink(name_.c_str());
  }
  [[nodiscard]] bool ok() const { return descriptor_ >= 0; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool read(std::vector<unsigned char>& bytes) const {
    std::ifstream file(name_, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
    return file.good() || file.eof();
  }

 private:
  std::string name_;
  int descriptor_ = -1;
};

/// Whether the last part of a file can be read: the library does not look whether its last bytes found room.
std::string check_last_part(const MesocellImage& image, const std::string& name) {
  using namespace OIIO;
  const std::unique_ptr<ImageInput> input = ImageInput::create(image.format);
  ImageSpec spec;
  if (!input || !input->open(name, spec)) return "what was written cannot be read";
  std::vector<char> row(std::size_t(spec.scanline_bytes(true)));
  if (!input->seek_subimage(int(image.page_count) - 1, 0) ||
      !input->read_native_scanline(int(image.page_count) - 1, 0, int(image.height) - 1, 0, row.data()))
    return "the disk of the folder for temporary files is full";
  return {};
}

/// Puts the picture's file into `bytes`. Empty if that was done.
std::string encode(const MesocellImage& image, std::vector<unsigned char>& bytes) {
  using namespace OIIO;
  std::unique_ptr<ImageOutput> output = ImageOutput::create(image.format);
  if (!output) return geterror();
  if (image.page_count > 1 && !output->supports("multiimage")) return "the format holds one picture";
  // Of several pages the library writes none to memory, or the last alone, and does not say so.
  if (image.page_count > 1) {
    const ScratchFile file;
    if (!file.ok()) return "no temporary file can be made";
    if (const std::string error = write_pages(*output, image, file.name()); !error.empty()) return error;
    if (const std::string error = check_last_part(image, file.name()); !error.empty()) return error;
    return file.read(bytes) ? std::string() : "what was written cannot be read";
  }
  Filesystem::IOVecOutput memory(bytes);
  if (!output->set_ioproxy(&memory)) return "this version of OpenImageIO cannot write it to memory";
  return write_pages(*output, image, image.format);
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
  if (request.reader->first_only == 0 && input->seek_subimage(int(request.page_count), 0))
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

/// Keeps what libpng prints of a damaged file, whose error is reported as it should, off the terminal: the
/// image library leaves it no other way. One at a time, as standard error is the whole process's.
class Hush {
 public:
  Hush() : lock_(mutex()) {
    std::fflush(stderr);
    kept_ = dup(STDERR_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) close(nowhere);
  }
  Hush(const Hush&) = delete;
  Hush& operator=(const Hush&) = delete;
  ~Hush() {
    std::fflush(stderr);
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  int kept_ = -1;
};

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

std::unique_ptr<Hush> hush_for(std::string_view format) {
  return format == "png" ? std::make_unique<Hush>() : nullptr;
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
    const std::unique_ptr<Hush> hush = hush_for(format);
    return int(read({path, format, max_bytes, make_room, context}, error));
  });
}

__attribute__((visibility("default"))) int mesocell_read_pages(const char* path, const char* format,
                                                               uint32_t page_count, uint64_t max_bytes,
                                                               const MesocellPageReader* reader,
                                                               char* message, size_t message_bytes) {
  return guarded(message, message_bytes, [&](std::string& error) {
    const std::unique_ptr<Hush> hush = hush_for(format);
    return int(read_pages({path, format, page_count, max_bytes, reader}, error));
  });
}
}
