#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "format/result.h"

namespace mesocell {

/// A plain file that is open for reading, also by several threads at once.
class InputFile {
 public:
  /// Pipes and devices, which may be waited for without end, are refused. Errors: kUnreadable, kLimit.
  [[nodiscard]] static Result<InputFile> open(const std::string& path, std::uint64_t max_bytes);

  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) = delete;
  ~InputFile();

  /// Bytes of the file when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Fills `bytes` from `offset` on; false if the file ends before, or cannot be read.
  [[nodiscard]] bool read_at(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  InputFile() = default;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace mesocell
