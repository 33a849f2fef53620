#pragma once

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "format/result.h"

namespace mesocell {

/// What `call` returns, a system call that gives −1 on failure, made again as long as a signal interrupts it.
template <typename Call>
auto retried(Call call) {
  for (;;) {
    const auto result = call();
    if (result != -1 || errno != EINTR) return result;
  }
}

/// The system's words for an errno.
inline std::string reason(int error) { return std::generic_category().message(error); }

inline Error unreadable(std::string message) { return Error{ErrorCode::kUnreadable, std::move(message)}; }

}  // namespace mesocell
