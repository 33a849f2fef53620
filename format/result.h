#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// What kind of thing went wrong. Each maps to one exit code of the command.
enum class ErrorCode : std::uint8_t {
  kUsage,         ///< an argument or option has no meaning (exit 2)
  kUnreadable,    ///< the input is missing or cannot be read (exit 3)
  kInvalidInput,  ///< the input was read and is not what it should be (exit 3)
  kOutput,        ///< the output could not be written (exit 4)
  kLimit,         ///< well-formed, but over a limit of the caller or of memory (exit 5)
  kCancelled,     ///< the caller asked to stop (exit 130)
};

/// A failure. `message` says what is wrong and, where one exists, the remedy; it does not name the file.
struct Error {
  ErrorCode code = ErrorCode::kInvalidInput;
  std::string message;
  /// Id of an issue or diagnosis, e.g. "header-magic"; empty where none applies. Always a string literal.
  std::string_view id = {};
  /// Byte offset in the file, where it is known.
  std::optional<std::uint64_t> offset = std::nullopt;
  /// Four-character code of the chunk, 0 outside any chunk.
  std::uint32_t chunk = 0;
};

/// What is returned where memory ran out. Allocates nothing, for its text fits in a string without.
[[nodiscard]] inline Error out_of_memory() {
  return Error{ErrorCode::kLimit, "out of memory", "limit-exceeded"};
}

/// A value or an Error. What a file did wrong is returned; what a programmer did wrong asserts.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Error error) : error_(std::move(error)) {}

  [[nodiscard]] bool ok() const { return value_.has_value(); }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] T& value() & {
    assert(ok());
    return *value_;
  }
  [[nodiscard]] const T& value() const& {
    assert(ok());
    return *value_;
  }
  [[nodiscard]] T&& value() && {
    assert(ok());
    return std::move(*value_);
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  [[nodiscard]] const Error& error() const {
    assert(!ok());
    return error_;
  }

 private:
  std::optional<T> value_;
  Error error_;
};

/// Success or an Error.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error) : error_(std::move(error)) {}

  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const Error& error() const {
    assert(!ok());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace mesocell
