#include "converters/vdb/scan_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "converters/image/extension.h"
#include "converters/image/input_file.h"
#include "format/byte_reader.h"

namespace mesocell {
namespace {

constexpr std::string_view kInr = "#INRIMAGE-4#{";
constexpr std::size_t kInrBlock = 256, kMaxHead = 1 << 16;
constexpr std::uint32_t kMaxSize = 1 << 20;

Error wrong(const std::string& what) { return {ErrorCode::kInvalidInput, what}; }

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\0'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// N numbers with blanks between them and nothing else.
template <std::size_t N>
std::optional<std::array<double, N>> numbers_of(std::string_view text) {
  std::array<double, N> values{};
  for (double& v : values) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), v);
    if (status != std::errc() || !std::isfinite(v)) return std::nullopt;
    text.remove_prefix(std::size_t(end - text.data()));
  }
  if (!trimmed(text).empty()) return std::nullopt;
  return values;
}

using Keys = std::map<std::string, std::string, std::less<>>;

const std::string* find(const Keys& keys, std::string_view key) {
  const auto at = keys.find(key);
  return at == keys.end() ? nullptr : &at->second;
}

/// The first of several keys that is there.
const std::string* find_any(const Keys& keys, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (const std::string* value = find(keys, name)) return value;
  return nullptr;
}

/// Names that are not in the list: what they say is passed over.
std::vector<std::string> unused_names(const Keys& keys, std::initializer_list<std::string_view> known) {
  std::vector<std::string> names;
  for (const auto& entry : keys)
    if (std::find(known.begin(), known.end(), entry.first) == known.end()) names.push_back(entry.first);
  return names;
}

Status set_size(const std::array<double, 3>& size, const ScanReadOptions& options, ScanHead& head) {
  std::uint64_t voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(size[a] >= 1 && size[a] <= kMaxSize && size[a] == std::floor(size[a])))
      return wrong("its size is not of three whole numbers from 1 to 1048576; repair its head");
    head.size[a] = std::uint32_t(size[a]);
    if (voxels > options.max_voxels / head.size[a])
      return Error{ErrorCode::kLimit, "it has more than " + std::to_string(options.max_voxels) +
                                          " voxels; crop it, or scale it down"};
    voxels *= head.size[a];
  }
  return {};
}

Status set_place(const std::array<double, 3>& spacing, const std::array<double, 3>& offset, ScanHead& head) {
  head.index_to_world = translation(to_vec3(offset)) * scaling(to_vec3(spacing));
  if (!is_sound(head.index_to_world))
    return wrong("the spacing of its voxels is zero or not finite; repair its head");
  return {};
}

bool is_true(const std::string* value) {
  return value && !value->empty() && ((*value)[0] == 'T' || (*value)[0] == 't' || (*value)[0] == '1');
}

/// "Key = value" lines, up to that of ElementDataFile, which is the last.
Result<ScanHead> parse_meta(std::string_view text, const ScanReadOptions& options) {
  Keys keys;
  ScanHead head;
  head.format = "MetaImage";
  std::size_t at = 0;
  while (at < text.size() && !keys.contains("ElementDataFile")) {
    const std::size_t end = text.find('\n', at);
    const std::string_view line = text.substr(at, end == text.npos ? end : end - at);
    at = end == text.npos ? text.size() : end + 1;
    const std::size_t equals = line.find('=');
    if (equals == line.npos) {
      if (trimmed(line).empty()) continue;
      return wrong("its head has a line without '='; it is no MetaImage, or damaged");
    }
    keys[std::string(trimmed(line.substr(0, equals)))] = trimmed(line.substr(equals + 1));
  }
  const std::string* const file = find(keys, "ElementDataFile");
  if (!file || file->empty())
    return wrong("its head does not say where its numbers are (ElementDataFile); repair it");
  if (const std::string* type = find(keys, "ObjectType"); type && *type != "Image")
    return wrong("it is a MetaIO object that is no Image; export an image");
  const std::string* const dimensions = find(keys, "NDims");
  if (!dimensions || *dimensions != "3")
    return wrong("it has not three dimensions (NDims); export it with three");
  if (is_true(find(keys, "CompressedData")))
    return wrong("its numbers are compressed, which is not read; save it uncompressed");
  if (const std::string* binary = find(keys, "BinaryData"); binary && !is_true(binary))
    return wrong("its numbers are text, which is not read; save it as binary");
  if (const std::string* channels = find(keys, "ElementNumberOfChannels"); channels && *channels != "1")
    return wrong("it has several numbers a voxel (ElementNumberOfChannels); save one of them alone");
  if (const std::string* skip = find(keys, "HeaderSize"); skip && *skip != "0")
    return wrong("its numbers stand behind another head (HeaderSize), which is not read; save it without");
  if (const std::string* matrix = find_any(keys, {"TransformMatrix", "Rotation", "Orientation"})) {
    const auto m = numbers_of<9>(*matrix);
    if (!m || *m != std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1})
      return wrong(
          "its axes are turned (TransformMatrix), which is not read; resample it to axes that are not");
  }
  const std::string* const size_text = find(keys, "DimSize");
  const auto size = size_text ? numbers_of<3>(*size_text) : std::nullopt;
  if (!size) return wrong("its head has no size of three numbers (DimSize); repair it");
  if (Status status = set_size(*size, options, head); !status) return status.error();
  const std::string* const spacing_text = find_any(keys, {"ElementSpacing", "ElementSize"});
  const auto spacing = numbers_of<3>(spacing_text ? *spacing_text : "1 1 1");
  const std::string* const offset_text = find_any(keys, {"Offset", "Position", "Origin"});
  const auto offset = numbers_of<3>(offset_text ? *offset_text : "0 0 0");
  if (!spacing || !offset)
    return wrong("its spacing or offset is not of three finite numbers; repair its head");
  if (Status status = set_place(*spacing, *offset, head); !status) return status.error();
  const std::string* const type = find(keys, "ElementType");
  constexpr std::array<std::pair<std::string_view, ScanHead::Number>, 5> kTypes = {
      {{"MET_UCHAR", ScanHead::Number::kU8},
       {"MET_CHAR", ScanHead::Number::kI8},
       {"MET_USHORT", ScanHead::Number::kU16},
       {"MET_SHORT", ScanHead::Number::kI16},
       {"MET_FLOAT", ScanHead::Number::kFloat}}};
  const auto row =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& r) { return type && r.first == *type; });
  if (row == kTypes.end())
    return wrong(
        "its numbers are of a type (ElementType) that is not read; there are: MET_UCHAR, MET_CHAR, "
        "MET_USHORT, MET_SHORT, MET_FLOAT");
  head.number = row->second;
  head.big_endian = is_true(find_any(keys, {"ElementByteOrderMSB", "BinaryDataByteOrderMSB"}));
  head.unused = unused_names(keys, {"ObjectType",
                                    "ObjectSubType",
                                    "NDims",
                                    "BinaryData",
                                    "BinaryDataByteOrderMSB",
                                    "ElementByteOrderMSB",
                                    "CompressedData",
                                    "DimSize",
                                    "ElementSpacing",
                                    "ElementSize",
                                    "Offset",
                                    "Position",
                                    "Origin",
                                    "TransformMatrix",
                                    "Rotation",
                                    "Orientation",
                                    "CenterOfRotation",
                                    "ElementNumberOfChannels",
                                    "HeaderSize",
                                    "ElementType",
                                    "ElementDataFile"});
  if (*file == "LOCAL") {
    head.data_at = at;
    return head;
  }
  if (file->find('/') != file->npos || file->find('\\') != file->npos || *file == "." || *file == ".." ||
      *file == "LIST" || file->find('%') != file->npos)
    return wrong("its numbers are not in one file beside it (ElementDataFile); save it as one file, .mha");
  head.data_file = *file;
  return head;
}

/// "KEY=value" lines in blocks of 256 bytes, the last of which ends in "##}".
Result<ScanHead> parse_inr(std::string_view text, const ScanReadOptions& options) {
  ScanHead head;
  head.format = "INRIMAGE-4";
  const std::size_t end = text.find("##}");
  if (end == text.npos) return wrong("its head has no end (##}); it is damaged or cut short");
  head.data_at = (end + 3 + kInrBlock - 1) / kInrBlock * kInrBlock;
  Keys keys;
  std::string_view rest = text.substr(kInr.size(), end - kInr.size());
  while (!rest.empty()) {
    const std::size_t stop = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, stop);
    rest.remove_prefix(std::min(stop + 1, rest.size()));
    const std::size_t equals = line.find('=');
    if (equals != line.npos)
      keys[std::string(trimmed(line.substr(0, equals)))] = trimmed(line.substr(equals + 1));
  }
  const auto number = [&](std::string_view key, double missing) {
    const std::string* const value = find(keys, key);
    const auto n = value ? numbers_of<1>(*value) : std::array<double, 1>{missing};
    return n ? (*n)[0] : std::nan("");
  };
  if (Status status = set_size({number("XDIM", 0), number("YDIM", 0), number("ZDIM", 0)}, options, head);
      !status)
    return status.error();
  if (number("VDIM", 1) != 1) return wrong("it has several numbers a voxel (VDIM); save one of them alone");
  if (Status status = set_place({number("VX", 1), number("VY", 1), number("VZ", 1)},
                                {number("TX", 0), number("TY", 0), number("TZ", 0)}, head);
      !status)
    return status.error();
  const std::string* const type = find(keys, "TYPE");
  const std::string* const bits = find(keys, "PIXSIZE");
  const std::string wanted = (type ? *type : "") + " " + (bits ? *bits : "");
  constexpr std::array<std::pair<std::string_view, ScanHead::Number>, 5> kTypes = {
      {{"unsigned fixed 8 bits", ScanHead::Number::kU8},
       {"signed fixed 8 bits", ScanHead::Number::kI8},
       {"unsigned fixed 16 bits", ScanHead::Number::kU16},
       {"signed fixed 16 bits", ScanHead::Number::kI16},
       {"float 32 bits", ScanHead::Number::kFloat}}};
  const auto row =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& r) { return r.first == wanted; });
  if (row == kTypes.end())
    return wrong(
        "its numbers are of a type (TYPE, PIXSIZE) that is not read; there are: unsigned fixed and "
        "signed fixed of 8 or 16 bits, float of 32 bits");
  head.number = row->second;
  const std::string* const cpu = find(keys, "CPU");
  const std::string order = cpu ? *cpu : "";
  if (order != "decm" && order != "alpha" && order != "pc" && order != "sun" && order != "sgi")
    return wrong("the order of its bytes (CPU) is not known; there are: decm, alpha, pc, sun, sgi");
  head.big_endian = order == "sun" || order == "sgi";
  head.unused = unused_names(keys, {"XDIM", "YDIM", "ZDIM", "VDIM", "VX", "VY", "VZ", "TX", "TY", "TZ",
                                    "TYPE", "PIXSIZE", "CPU", "SCALE"});
  return head;
}

float number_at(const std::byte* bytes, ScanHead::Number number, bool big_endian) {
  using Number = ScanHead::Number;
  const auto byte = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  if (number == Number::kU8) return float(byte(0));
  if (number == Number::kI8) return float(std::int8_t(byte(0)));
  const std::size_t size = number == Number::kFloat ? 4 : 2;
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) bits |= byte(big_endian ? size - 1 - i : i) << (8 * i);
  if (number == Number::kU16) return float(bits);
  if (number == Number::kI16) return float(std::int16_t(std::uint16_t(bits)));
  return std::bit_cast<float>(bits);
}

}  // namespace

bool has_scan_extension(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".mhd" || extension == ".mha" || extension == ".inr";
}

Result<ScanHead> parse_scan_head(std::span<const std::byte> bytes, const ScanReadOptions& options) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kMaxHead));
  if (text.starts_with(kInr)) return parse_inr(text, options);
  if (text.starts_with("ObjectType") || text.starts_with("NDims") || text.starts_with("Comment"))
    return parse_meta(text, options);
  return wrong(text.empty() ? "it is empty, and no volume; export it again"
                            : "it is neither a MetaImage nor an INRIMAGE-4, as it does not begin like one; "
                              "give it the extension of what it is");
}

Result<SparseVolume> read_scan(const std::string& path, const ScanReadOptions& options, ReadNotes* notes) {
  constexpr std::uint64_t kMaxBytes = ~std::uint64_t{0};
  Result<InputFile> file = InputFile::open(path, kMaxBytes);
  if (!file) return file.error();
  std::vector<std::byte> begin(std::min<std::uint64_t>(file->size(), kMaxHead));
  if (!file->read_at(0, begin)) return Error{ErrorCode::kUnreadable, "it cannot be read; try again"};
  const Result<ScanHead> head = parse_scan_head(begin, options);
  if (!head) return head.error();
  constexpr std::size_t kMaxName = 48;
  if (notes)
    for (const std::string& name : head->unused) notes->lose("field " + name.substr(0, kMaxName));
  const std::uint64_t bytes = head->voxel_count() * head->number_bytes();
  std::optional<Result<InputFile>> beside;
  if (!head->data_file.empty()) {
    const std::filesystem::path data = std::filesystem::path(path).parent_path() / head->data_file;
    if (notes) notes->files.insert(data.string());
    beside.emplace(InputFile::open(data.string(), kMaxBytes));
    if (!*beside)
      return Error{beside->error().code,
                   "its numbers in '" + head->data_file + "' beside it: " + beside->error().message};
  }
  const InputFile& data = beside ? **beside : *file;
  if (data.size() < head->data_at || data.size() - head->data_at != bytes)
    return wrong("its numbers take " + std::to_string(bytes) + " bytes by its head, but there are " +
                 std::to_string(data.size() - std::min<std::uint64_t>(head->data_at, data.size())) +
                 "; it is cut short or its head is wrong");
  std::vector<std::byte> raw(bytes);
  if (!data.read_at(head->data_at, raw)) return Error{ErrorCode::kUnreadable, "it cannot be read; try again"};
  std::vector<float> values(head->voxel_count());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = number_at(raw.data() + i * head->number_bytes(), head->number, head->big_endian);
  raw = {};
  SparseVolume volume = make_sparse(values, head->size);
  volume.name = head->format;
  volume.index_to_world = head->index_to_world;
  return volume;
}

}  // namespace mesocell
