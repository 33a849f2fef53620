#include "converters/import/picture_file.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "converters/image/exr_check.h"
#include "converters/image/extension.h"
#include "converters/image/input_file.h"
#include "converters/import/sniff.h"
#include "converters/import/tiff_check.h"

namespace mesocell {
namespace {

using namespace std::string_view_literals;

/// How a picture begins, and the image library's name for its format.
struct Mark {
  std::string_view begins;
  const char* format;
};
constexpr std::array<Mark, 9> kMarks = {{
    {"\x89PNG\r\n\x1a\n"sv, "png"},
    {"II*\0"sv, "tiff"},
    {"MM\0*"sv, "tiff"},
    {"II+\0"sv, "tiff"},
    {"MM\0+"sv, "tiff"},
    {"\x76\x2f\x31\x01"sv, "openexr"},
    {"#?RADIANCE"sv, "hdr"},
    {"#?RGBE"sv, "hdr"},
    {"\xff\xd8\xff"sv, "jpeg"},
}};

}  // namespace

const char* picture_format(std::string_view head) {
  for (const Mark& mark : kMarks)
    if (head.starts_with(mark.begins)) return mark.format;
  return nullptr;
}

Result<PictureFile> examine_picture(const std::string& path, const PictureLimits& limits) {
  const Result<InputFile> file = InputFile::open(path, limits.max_file_bytes);
  if (!file) return file.error();
  if (file->size() == 0)
    return Error{ErrorCode::kInvalidInput, "the file is empty; fetch or export it again"};
  std::array<std::byte, 1024> head{};
  const std::size_t head_bytes = std::size_t(std::min<std::uint64_t>(file->size(), head.size()));
  if (!file->read_at(0, std::span(head).first(head_bytes)))
    return Error{ErrorCode::kUnreadable, "it cannot be read; check the disk"};
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head_bytes);
  PictureFile picture;
  picture.format = picture_format(text);
  if (!picture.format) {
    std::string_view content = sniff_content(text);
    if (content.empty()) content = sniff_name(lower_extension(path), file->size());
    std::string message =
        "the file is " + (content.empty() ? "no picture that can be read" : std::string(content));
    if (const std::string_view remedy = terrain_remedy(content); !remedy.empty())
      message += ", which is not read; " + std::string(remedy);
    return Error{ErrorCode::kInvalidInput, std::move(message)};
  }
  if (picture.format == "tiff"sv) {
    const Result<TiffLayout> layout = check_tiff(*file, limits.max_pages, limits.max_side);
    if (!layout) return layout.error();
    picture.pages = layout->pages;
    picture.stored_bits = layout->bits;
  }
  if (picture.format == "openexr"sv)
    if (Status status = check_exr(*file, limits.max_side); !status) return status.error();
  // Bit depth and color type of the header; 0 is gray [PNG 11.2.1].
  if (picture.format == "png"sv && text.size() > 25 && text[25] == 0)
    picture.stored_bits = std::uint8_t(text[24]);
  return picture;
}

}  // namespace mesocell
