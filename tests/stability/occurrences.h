#pragma once

#include <cstddef>
#include <string>

/// How often a part is in a text, parts that overlap counted once.
inline std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) ++n;
  return n;
}
