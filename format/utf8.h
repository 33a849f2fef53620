#pragma once

#include <string_view>

namespace mesocell {

/// Whether the bytes are UTF-8 without surrogates and overlong forms. [RFC 3629]
[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace mesocell
