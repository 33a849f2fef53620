#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"

namespace mesocell {

enum class PlyEncoding : std::uint8_t { kText, kLittleEndian, kBigEndian };
enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// Bytes of a value in a binary PLY.
[[nodiscard]] std::size_t ply_type_bytes(PlyType type);

struct PlyProperty {
  std::string name;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< of a list's length
  PlyType type = PlyType::kFloat32;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< of comments "TextureFile NAME"
  std::size_t body = 0;  ///< offset of the first byte after the header
};

/// Parses the header of a PLY file. Untrusted input: safe; counts are those of the header, unchecked.
/// Errors: kInvalidInput.
[[nodiscard]] Result<PlyHeader> parse_ply_header(std::string_view bytes);

}  // namespace mesocell
