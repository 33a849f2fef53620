#pragma once

#include <charconv>
#include <string>
#include <system_error>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// The shortest text that gives the same double again, whatever the language of the machine.
[[nodiscard]] inline std::string number_text(double x) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, x);
  return error == std::errc() ? std::string(text, end) : std::string();
}

}  // namespace mesocell
