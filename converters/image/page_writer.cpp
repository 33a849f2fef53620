#include "converters/image/page_writer.h"

#include <array>
#include <cassert>
#include <new>
#include <string_view>

#include "converters/image/extension.h"
#include "converters/image/image_module_access.h"

namespace mesocell {
namespace {

struct PageFormat {
  std::string_view extension;
  const char* name;
};
constexpr std::array<PageFormat, 4> kPageFormats = {
    {{".png", "png"}, {".tif", "tiff"}, {".tiff", "tiff"}, {".exr", "openexr"}}};

const PageFormat* find_page_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const PageFormat& format : kPageFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

MesocellPixelType pixel_type(PageSampleType type) {
  switch (type) {
    case PageSampleType::kUint8:
      return kMesocellPixelData8;
    case PageSampleType::kUint16:
      return kMesocellPixelData16;
    case PageSampleType::kUint32:
      return kMesocellPixelData32;
    case PageSampleType::kFloat:
      return kMesocellPixelFloat;
    case PageSampleType::kSrgb8:
      break;
  }
  return kMesocellPixelUint8;
}

void take_bytes(void* context, const void* bytes, std::size_t count) {
  auto& to = *static_cast<std::vector<std::byte>*>(context);
  const auto* begin = static_cast<const std::byte*>(bytes);
  try {
    to.assign(begin, begin + count);
  } catch (const std::bad_alloc&) {
    to.clear();
  }
}

}  // namespace

std::size_t page_sample_bytes(PageSampleType type) {
  switch (type) {
    case PageSampleType::kUint8:
    case PageSampleType::kSrgb8:
      return 1;
    case PageSampleType::kUint16:
      return 2;
    default:
      return 4;
  }
}

Status check_page_path(const std::string& path, PageSampleType type, std::uint32_t pages) {
  const PageFormat* format = find_page_format(path);
  const auto usage = [](std::string text) { return Error{ErrorCode::kUsage, std::move(text)}; };
  if (!format) return usage("its extension is not one of pictures; use .png, .tif or .exr");
  const std::string_view name = format->name;
  if (name == "png" && pages > 1) return usage("a PNG is one picture; use .tif or a folder");
  if (name == "png" && (type == PageSampleType::kFloat || type == PageSampleType::kUint32))
    return usage("a PNG has no such numbers; use .tif");
  if (name == "openexr" && type != PageSampleType::kFloat) return usage("an EXR has floats; use .tif");
  return {};
}

Result<std::vector<std::byte>> encode_pages(const std::string& path, const PageStack& stack) {
  assert(stack.samples.size() == std::uint64_t{stack.width} * stack.height * stack.pages *
                                     stack.channels.size() * page_sample_bytes(stack.type));
  if (Status status = check_page_path(path, stack.type, stack.pages); !status) return status.error();
  const Result<ImageModule>& module = image_module();
  if (!module) return module.error();
  std::vector<const char*> names;
  for (const std::string& name : stack.channels) names.push_back(name.c_str());
  const MesocellImage picture{find_page_format(path)->name,
                              stack.width,
                              stack.height,
                              std::uint32_t(names.size()),
                              stack.pages,
                              pixel_type(stack.type),
                              names.data(),
                              stack.samples.data()};
  std::array<char, 512> message{};
  std::vector<std::byte> bytes;
  if (module->encode(&picture, take_bytes, &bytes, message.data(), message.size()) != 0)
    return Error{ErrorCode::kOutput,
                 std::string("the pictures could not be encoded (") + message.data() + ")"};
  if (bytes.empty())
    return Error{ErrorCode::kLimit, "there is not enough memory to write the pictures; make them smaller"};
  return bytes;
}

}  // namespace mesocell
