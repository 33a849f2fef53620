#include "converters/import/ply_header.h"

#include <array>
#include <optional>
#include <utility>

#include "converters/import/mesh_text.h"

namespace mesocell {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},
    {"float32", PlyType::kFloat32},
    {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64},
}};

std::optional<PlyType> find_type(std::string_view name) {
  for (const auto& [key, type] : kTypes)
    if (key == name) return type;
  return std::nullopt;
}

Error bad_line(std::uint64_t line) {
  return invalid_line(line, "the PLY header cannot be understood here; export the mesh again");
}

bool is_integer_type(PlyType type) { return type != PlyType::kFloat32 && type != PlyType::kFloat64; }

std::optional<PlyProperty> parse_property(std::string_view rest) {
  PlyProperty property;
  std::string_view type = next_word(rest);
  if (type == "list") {
    property.is_list = true;
    const std::optional<PlyType> count = find_type(next_word(rest));
    if (!count || !is_integer_type(*count)) return std::nullopt;
    property.count_type = *count;
    type = next_word(rest);
  }
  const std::optional<PlyType> value = find_type(type);
  const std::string_view name = next_word(rest);
  if (!value || name.empty()) return std::nullopt;
  property.type = *value;
  property.name = name;
  return property;
}

std::optional<PlyEncoding> parse_encoding(std::string_view name) {
  if (name == "ascii") return PlyEncoding::kText;
  if (name == "binary_little_endian") return PlyEncoding::kLittleEndian;
  if (name == "binary_big_endian") return PlyEncoding::kBigEndian;
  return std::nullopt;
}

}  // namespace

std::size_t ply_type_bytes(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 8;
}

Result<PlyHeader> parse_ply_header(std::string_view bytes) {
  PlyHeader header;
  LineReader lines(bytes);
  std::string_view line;
  if (!lines.next(line) || (next_word(line) != "ply"))
    return invalid_mesh("the file does not begin with ply, so it is not a PLY mesh; check the file");
  bool has_format = false;
  while (lines.next(line)) {
    const std::string_view key = next_word(line);
    if (key == "end_header") {
      if (!has_format) return invalid_mesh("the PLY header does not say its format; export the mesh again");
      header.body = lines.offset();
      return header;
    }
    if (key == "format") {
      const std::optional<PlyEncoding> encoding = parse_encoding(next_word(line));
      if (!encoding) return bad_line(lines.number());
      header.encoding = *encoding;
      has_format = true;
    } else if (key == "element") {
      PlyElement element;
      element.name = next_word(line);
      std::int64_t count = 0;
      if (element.name.empty() || !parse_integer(next_word(line), count) || count < 0)
        return bad_line(lines.number());
      element.count = std::uint64_t(count);
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      std::optional<PlyProperty> property = parse_property(line);
      if (!property || header.elements.empty()) return bad_line(lines.number());
      header.elements.back().properties.push_back(std::move(*property));
    } else if (key == "comment") {
      if (next_word(line) != "TextureFile") continue;
      header.textures.emplace_back(trimmed(line));
    } else if (key != "obj_info" && !key.empty()) {
      return bad_line(lines.number());
    }
  }
  return invalid_mesh("the PLY header has no end; the file is cut off, fetch or export it again");
}

}  // namespace mesocell
