#include "converters/import/tiff_check.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mesocell {
namespace {

enum Tag : std::uint32_t {
  kWidth = 256,
  kHeight = 257,
  kBits = 258,
  kCompression = 259,
  kPhotometric = 262,
  kStripOffsets = 273,
  kOrientation = 274,
  kSamples = 277,
  kRowsPerStrip = 278,
  kStripBytes = 279,
  kPlanar = 284,
  kTileWidth = 322,
  kTileHeight = 323,
  kTileOffsets = 324,
  kTileBytes = 325,
  kSampleFormat = 339,
  kImageDepth = 32997,
  kTileDepth = 32998,
};

constexpr std::uint64_t kGray = 1, kRgb = 2, kPalette = 3;
constexpr std::uint64_t kUint = 1, kInt = 2, kFloat = 3;
constexpr std::uint64_t kMaxEntries = 4096, kMaxTileSide = 4096;

/// Bytes of a value of the types 1 to 18, 0 if there is no such type.
constexpr std::array<std::uint8_t, 19> kTypeBytes = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};

struct Entry {
  std::uint64_t type = 0, count = 0;
  std::uint64_t at = 0;  ///< where its values are
};

Error bad_tiff(std::string message) { return Error{ErrorCode::kInvalidInput, std::move(message)}; }
Error cut_off() {
  return bad_tiff("its directory leads beyond the end of the file; it is cut off or damaged, fetch it again");
}

/// One page's directory and what is needed to read numbers of the file.
class Page {
 public:
  Page(const InputFile& file, bool big_endian, bool big_tiff)
      : file_(file), big_endian_(big_endian), offset_bytes_(big_tiff ? 8 : 4) {}

  /// The whole number in `bytes` bytes at `offset`; nothing if the file ends before.
  [[nodiscard]] std::optional<std::uint64_t> number(std::uint64_t offset, std::size_t bytes) const {
    std::array<std::byte, 8> raw{};
    if (!file_.read_at(offset, std::span(raw).first(bytes))) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < bytes; ++k)
      value = value << 8 | std::uint64_t(raw[big_endian_ ? k : bytes - 1 - k]);
    return value;
  }
  [[nodiscard]] std::size_t offset_bytes() const { return offset_bytes_; }

  /// Reads the directory at `offset`; returns the offset of the next one, 0 after the last.
  Result<std::uint64_t> read(std::uint64_t offset);

  [[nodiscard]] bool has(Tag tag) const { return entries_.contains(tag); }
  [[nodiscard]] std::uint64_t count(Tag tag) const { return has(tag) ? entries_.at(tag).count : 0; }
  /// The value of a tag, `fallback` if it is not there. If it has several they must be equal.
  Result<std::uint64_t> value(Tag tag, std::optional<std::uint64_t> fallback = std::nullopt) const;
  /// Value `k` of a tag of offsets or sizes.
  [[nodiscard]] std::optional<std::uint64_t> element(Tag tag, std::uint64_t k) const;

 private:
  const InputFile& file_;
  bool big_endian_;
  std::size_t offset_bytes_;
  std::map<std::uint64_t, Entry> entries_;
};

Result<std::uint64_t> Page::read(std::uint64_t offset) {
  const std::size_t count_bytes = offset_bytes_ == 8 ? 8 : 2, entry_bytes = 4 + 2 * offset_bytes_;
  const std::optional<std::uint64_t> count = number(offset, count_bytes);
  if (!count) return cut_off();
  if (*count == 0 || *count > kMaxEntries)
    return bad_tiff("its directory has " + std::to_string(*count) +
                    " entries; it is damaged, fetch it again");
  entries_.clear();
  std::uint64_t at = offset + count_bytes;
  for (std::uint64_t k = 0; k < *count; ++k, at += entry_bytes) {
    const auto tag = number(at, 2), type = number(at + 2, 2), values = number(at + 4, offset_bytes_);
    const auto link = number(at + 4 + offset_bytes_, offset_bytes_);
    if (!tag || !type || !values || !link) return cut_off();
    const std::uint64_t bytes = *type < kTypeBytes.size() ? kTypeBytes[*type] : 0;
    if (bytes == 0)
      return bad_tiff("its directory has an entry of an unknown type; it is damaged, fetch it again");
    if (*values > file_.size() / bytes) return cut_off();
    const bool inside = *values * bytes <= offset_bytes_;
    if (!inside && (*link > file_.size() || *values * bytes > file_.size() - *link)) return cut_off();
    if (!entries_.emplace(*tag, Entry{*type, *values, inside ? at + 4 + offset_bytes_ : *link}).second)
      return bad_tiff("its directory has tag " + std::to_string(*tag) +
                      " twice; it is damaged, fetch it again");
  }
  const std::optional<std::uint64_t> next = number(at, offset_bytes_);
  if (!next) return cut_off();
  return *next;
}

std::optional<std::uint64_t> Page::element(Tag tag, std::uint64_t k) const {
  const Entry& entry = entries_.at(tag);
  // BYTE, SHORT, LONG, LONG8
  if (entry.type != 1 && entry.type != 3 && entry.type != 4 && entry.type != 16) return std::nullopt;
  const std::size_t bytes = kTypeBytes[entry.type];
  return number(entry.at + k * bytes, bytes);
}

Result<std::uint64_t> Page::value(Tag tag, std::optional<std::uint64_t> fallback) const {
  if (!has(tag)) {
    if (fallback) return *fallback;
    return bad_tiff("its directory has no tag " + std::to_string(tag) + "; save it again");
  }
  std::optional<std::uint64_t> common;
  // Samples are at most 4, which is checked where they are many.
  for (std::uint64_t k = 0; k < std::min<std::uint64_t>(count(tag), 4); ++k) {
    const std::optional<std::uint64_t> value = element(tag, k);
    if (!value) return bad_tiff("its tag " + std::to_string(tag) + " is not a whole number; save it again");
    if (common && *common != *value)
      return bad_tiff("its channels are of different kinds (tag " + std::to_string(tag) +
                      "); save it with equal ones");
    common = value;
  }
  if (!common) return bad_tiff("its tag " + std::to_string(tag) + " is empty; save it again");
  return *common;
}

/// What a page is, as its tags say.
struct Facts {
  std::uint64_t width, height, samples, bits, format, photometric, compression, planar;
};

Result<Facts> read_facts(const Page& page) {
  Facts facts{};
  const struct {
    Tag tag;
    std::uint64_t* value;
    std::optional<std::uint64_t> fallback;
  } wanted[] = {
      {kWidth, &facts.width, {}},
      {kHeight, &facts.height, {}},
      {kSamples, &facts.samples, 1},
      {kBits, &facts.bits, 1},
      {kSampleFormat, &facts.format, kUint},
      {kPhotometric, &facts.photometric, {}},
      {kCompression, &facts.compression, 1},
      {kPlanar, &facts.planar, 1},
  };
  for (const auto& want : wanted) {
    const Result<std::uint64_t> value = page.value(want.tag, want.fallback);
    if (!value) return value.error();
    *want.value = *value;
  }
  return facts;
}

/// Whether the library reads pictures of this kind rightly.
Status check_kind(const Page& page, const Facts& f, std::uint32_t max_side) {
  if (f.width == 0 || f.height == 0) return bad_tiff("it has no pixels");
  if (f.width > max_side || f.height > max_side)
    return Error{ErrorCode::kLimit, "it has " + std::to_string(f.width) + " x " + std::to_string(f.height) +
                                        " pixels; at most " + std::to_string(max_side) +
                                        " are read along each side, make it smaller"};
  const auto refuse = [](const std::string& what, const std::string& remedy) {
    return bad_tiff("it " + what + ", which is not read; " + remedy);
  };
  if (f.photometric == 0) return refuse("has white as zero", "save it with black as zero");
  if (f.photometric != kGray && f.photometric != kRgb && f.photometric != kPalette)
    return refuse("has colors of kind " + std::to_string(f.photometric), "save it as gray or RGB");
  const bool rgb = f.photometric == kRgb;
  if (rgb ? f.samples < 3 || f.samples > 4 : f.samples < 1 || f.samples > 2)
    return refuse("has " + std::to_string(f.samples) + " channels", "save it as gray or RGB");
  if (f.photometric == kPalette && (f.samples != 1 || f.bits > 8 || f.format != kUint))
    return refuse("has a palette of more than 8 bits", "save it as RGB");
  const bool integer = f.format == kUint || f.format == kInt;
  const bool whole = f.bits == 8 || f.bits == 16 || f.bits == 32;
  const bool part = (f.bits == 1 || f.bits == 2 || f.bits == 4) && f.format == kUint && f.samples == 1;
  if (!(integer && (whole || part)) &&
      !(f.format == kFloat && (f.bits == 16 || f.bits == 32 || f.bits == 64)))
    return refuse("has samples of " + std::to_string(f.bits) + " bits of kind " + std::to_string(f.format),
                  "save it with 8, 16 or 32 bits");
  const std::array<std::uint64_t, 5> packings = {1, 5, 8, 32946, 32773};
  if (std::find(packings.begin(), packings.end(), f.compression) == packings.end())
    return refuse("is compressed by method " + std::to_string(f.compression),
                  "save it without compression, or with LZW, deflate or PackBits");
  if (f.planar != 1 && f.planar != 2)
    return refuse("has planes of kind " + std::to_string(f.planar), "save it again");
  const struct {
    Tag tag;
    const char* what;
  } ones[] = {{kOrientation, "is stored turned"},
              {kImageDepth, "has pages of several slices"},
              {kTileDepth, "has pages of several slices"}};
  for (const auto& one : ones) {
    const Result<std::uint64_t> value = page.value(one.tag, 1);
    if (!value) return value.error();
    if (*value != 1) return refuse(one.what, "save it upright, with a page for each slice");
  }
  return {};
}

/// Checks that strips or tiles are as many as there must be and lie within the file.
Status check_pieces(const Page& page, const Facts& f, std::uint64_t file_bytes) {
  const bool tiled = page.has(kTileWidth) || page.has(kTileHeight);
  if (page.has(tiled ? kStripOffsets : kTileOffsets) || page.has(tiled ? kStripBytes : kTileBytes))
    return bad_tiff("its directory names both strips and tiles; it is damaged, or save it again");
  const Result<std::uint64_t> across = tiled ? page.value(kTileWidth) : page.value(kTileWidth, f.width);
  const Result<std::uint64_t> rows = tiled ? page.value(kTileHeight) : page.value(kRowsPerStrip, f.height);
  if (!across) return across.error();
  if (!rows) return rows.error();
  if (*rows == 0 || *across == 0 ||
      (tiled && (*across % 16 != 0 || *rows % 16 != 0 || *across > kMaxTileSide || *rows > kMaxTileSide ||
                 f.bits < 8)))
    return bad_tiff("its strips or tiles have a size that cannot be; save it again");
  const auto pieces_of = [](std::uint64_t n, std::uint64_t size) { return n / size + (n % size != 0); };
  const std::uint64_t planes = f.planar == 2 ? f.samples : 1, down = pieces_of(f.height, *rows);
  const std::uint64_t expected = pieces_of(f.width, *across) * down * planes;
  const Tag offsets = tiled ? kTileOffsets : kStripOffsets, sizes = tiled ? kTileBytes : kStripBytes;
  if (page.count(offsets) != expected || page.count(sizes) != expected)
    return bad_tiff("its directory does not name the " + std::to_string(expected) +
                    " strips or tiles that the picture has; it is damaged, or save it again");
  const std::uint64_t row_bytes = (*across * (f.planar == 2 ? 1 : f.samples) * f.bits + 7) / 8;
  for (std::uint64_t k = 0; k < expected; ++k) {
    const auto offset = page.element(offsets, k), size = page.element(sizes, k);
    if (!offset || !size || *offset > file_bytes || *size > file_bytes - *offset)
      return bad_tiff("its pixels lie beyond the end of the file; it is cut off, fetch it again");
    const std::uint64_t rows_here = tiled ? *rows : std::min(*rows, f.height - k % down * *rows);
    if (*size == 0 || (f.compression == 1 && *size < row_bytes * rows_here))
      return bad_tiff("its strips or tiles are shorter than their pixels; it is damaged, fetch it again");
  }
  return {};
}

}  // namespace

Result<TiffLayout> check_tiff(const InputFile& file, std::uint32_t max_pages, std::uint32_t max_side) {
  std::array<std::byte, 4> mark{};
  if (!file.read_at(0, mark)) return cut_off();
  const bool big_endian = mark[0] == std::byte{'M'};
  const bool big_tiff = mark[big_endian ? 3 : 2] == std::byte{43};
  Page page(file, big_endian, big_tiff);
  // A BigTIFF says that its offsets have 8 bytes, then a zero.
  if (big_tiff && (page.number(4, 2) != 8u || page.number(6, 2) != 0u))
    return bad_tiff("its header is damaged; fetch it again");
  std::optional<std::uint64_t> first = page.number(big_tiff ? 8 : 4, page.offset_bytes());
  if (!first || *first == 0) return cut_off();

  TiffLayout layout;
  std::optional<Facts> common;
  std::set<std::uint64_t> seen;
  for (std::uint64_t offset = *first; offset != 0;) {
    const auto on_page = [&](Error error) {
      error.message = "page " + std::to_string(layout.pages + 1) + ": " + error.message;
      return error;
    };
    if (layout.pages == max_pages)
      return Error{ErrorCode::kLimit, "it has more than " + std::to_string(max_pages) + " pages; take fewer"};
    if (!seen.insert(offset).second)
      return on_page(bad_tiff("it is the same as one before; the file is damaged, fetch it again"));
    const Result<std::uint64_t> next = page.read(offset);
    if (!next) return on_page(next.error());
    const Result<Facts> facts = read_facts(page);
    if (!facts) return on_page(facts.error());
    if (Status status = check_kind(page, *facts, max_side); !status) return on_page(status.error());
    if (Status status = check_pieces(page, *facts, file.size()); !status) return on_page(status.error());
    if (common && (common->width != facts->width || common->height != facts->height))
      return on_page(bad_tiff("it has " + std::to_string(facts->width) + " x " +
                              std::to_string(facts->height) + " pixels, the first " +
                              std::to_string(common->width) + " x " + std::to_string(common->height) +
                              "; all must have the same size"));
    if (common && (common->samples != facts->samples || common->bits != facts->bits ||
                   common->format != facts->format || common->photometric != facts->photometric))
      return on_page(bad_tiff("its pixels are of another kind than those of the first; save all alike"));
    common = *facts;
    ++layout.pages;
    offset = *next;
  }
  if (common->photometric == kGray && common->format == kUint) layout.bits = std::uint32_t(common->bits);
  return layout;
}

}  // namespace mesocell
