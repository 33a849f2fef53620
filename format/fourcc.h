#pragma once

#include <cstdint>
#include <string>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// The four characters as they stand in the file, read as a little-endian number. [spec 2.3]
[[nodiscard]] constexpr std::uint32_t fourcc(const char (&text)[5]) {
  std::uint32_t v = 0;
  for (unsigned i = 0; i < 4; ++i) v |= std::uint32_t{static_cast<unsigned char>(text[i])} << (8 * i);
  return v;
}

/// The four characters as text; a byte that does not print, or a backslash, becomes \xNN. Any value is
/// allowed.
[[nodiscard]] inline std::string fourcc_text(std::uint32_t code) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (unsigned i = 0; i < 4; ++i) {
    const unsigned c = code >> (8 * i) & 0xffu;
    if (c >= 0x20 && c < 0x7f && c != '\\') {
      text += static_cast<char>(c);
    } else {
      text += "\\x";
      text += kHex[c >> 4];
      text += kHex[c & 15];
    }
  }
  return text;
}

}  // namespace mesocell
