#include "converters/import/dds_pages.h"

#include <array>
#include <bit>
#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "converters/image/input_file.h"
#include "format/byte_reader.h"

namespace mesocell {
namespace {

constexpr std::size_t kHeaderBytes = 128;
// Flags of the header, of its pixel format and of its capabilities.
constexpr std::uint32_t kHasDepth = 0x80'0000, kHasLevels = 0x2'0000, kAlpha = 0x1, kFourCc = 0x4,
                        kHasRgb = 0x40, kLuminance = 0x2'0000;
constexpr std::uint32_t kCubeMap = 0x200;

Error bad_dds(std::string message) { return Error{ErrorCode::kInvalidInput, std::move(message)}; }

}  // namespace

bool is_dds(std::string_view head) { return head.starts_with("DDS "); }

Result<DdsLayout> parse_dds_header(std::string_view header) {
  ByteReader in(std::as_bytes(std::span(header)));
  in.skip(4);
  const std::uint32_t size = in.u32(), flags = in.u32();
  DdsLayout layout;
  layout.height = in.u32();
  layout.width = in.u32();
  in.skip(4);
  const std::uint32_t depth = in.u32();
  const std::uint32_t levels = in.u32();
  in.skip(4 * 11);
  const std::uint32_t format_size = in.u32(), format = in.u32(), four_cc = in.u32(), bits = in.u32();
  const std::array<std::uint32_t, 3> masks = {in.u32(), in.u32(), in.u32()};
  in.skip(8);
  const std::uint32_t caps = in.u32();
  if (!is_dds(header) || in.overrun() || size != 124 || format_size != 32)
    return bad_dds("its DDS header is damaged or cut off; fetch or export it again");
  if (caps & kCubeMap) return bad_dds("it is a cube map; a volume is needed, or one picture");
  if ((format & kFourCc) && four_cc != 0)
    return bad_dds(
        "its pixels are compressed; save the DDS without compression, or as a TIFF of several pages");
  if (flags & kHasDepth) layout.depth = depth;
  layout.has_levels = (flags & kHasLevels) && levels > 1;
  layout.has_alpha = (format & kAlpha) != 0;
  if (layout.width == 0 || layout.height == 0 || layout.depth == 0) return bad_dds("it has no pixels");
  const bool gray = (format & kLuminance) != 0;
  if ((!gray && !(format & kHasRgb)) || bits % 8 != 0 || bits == 0 || bits > 32)
    return bad_dds("its kind of pixels is not read; save it with 8 bits a channel, gray or RGB");
  layout.pixel_bytes = bits / 8;
  for (std::size_t k = 0; k < (gray ? 1u : 3u); ++k) {
    const std::uint32_t mask = masks[k];
    const auto shift = std::uint32_t(std::countr_zero(mask));
    if (mask == 0 || shift + 8 > bits || mask != std::uint32_t{0xff} << shift)
      return bad_dds("its kind of pixels is not read; save it with 8 bits a channel, gray or RGB");
    layout.shifts.push_back(shift);
  }
  return layout;
}

Status read_dds_pages(const std::string& path, std::uint64_t max_file_bytes, const PageSink& sink) try {
  const Result<InputFile> file = InputFile::open(path, max_file_bytes);
  if (!file) return file.error();
  std::array<std::byte, kHeaderBytes> header{};
  if (file->size() < header.size() || !file->read_at(0, header))
    return bad_dds("its DDS header is damaged or cut off; fetch or export it again");
  const Result<DdsLayout> layout =
      parse_dds_header({reinterpret_cast<const char*>(header.data()), header.size()});
  if (!layout) return layout.error();
  const std::uint64_t room = file->size() - kHeaderBytes;
  // Each factor is checked before the next: none of the products overflows.
  const std::uint64_t row = std::uint64_t{layout->width} * layout->pixel_bytes;
  if (row > room || layout->height > room / row || layout->depth > room / row / layout->height)
    return bad_dds("its header promises more pixels than it has; it is cut off, fetch or export it again");
  PageHeader page;
  page.width = layout->width;
  page.height = layout->height;
  page.channels =
      layout->shifts.size() == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  page.bits = 8;
  page.is_float = sink.as_floats;
  page.encoding = ImageEncoding::kSrgb;
  page.exact = true;
  if (Status status = sink.begin(page); !status) return status;
  const std::size_t pixels = std::size_t{layout->width} * layout->height;
  std::vector<std::byte> bytes(pixels * layout->pixel_bytes);
  std::vector<std::uint32_t> samples(pixels * layout->shifts.size());
  for (std::uint32_t z = 0; z < layout->depth; ++z) {
    if (!file->read_at(kHeaderBytes + z * std::uint64_t{bytes.size()}, bytes))
      return Error{ErrorCode::kUnreadable, "it cannot be read to its end; check the disk"};
    std::size_t next = 0;
    for (std::size_t i = 0; i < bytes.size(); i += layout->pixel_bytes) {
      std::uint32_t pixel = 0;
      for (std::uint32_t k = 0; k < layout->pixel_bytes; ++k)
        pixel |= std::to_integer<std::uint32_t>(bytes[i + k]) << (8 * k);
      for (const std::uint32_t shift : layout->shifts) {
        const std::uint32_t value = pixel >> shift & 0xff;
        samples[next++] = sink.as_floats ? std::bit_cast<std::uint32_t>(float(value)) : value;
      }
    }
    if (Status status = sink.take(z, samples); !status) return status;
  }
  return {};
} catch (const std::bad_alloc&) {
  return Error{ErrorCode::kLimit, "there is not enough memory to read it; use a smaller one"};
}

}  // namespace mesocell
