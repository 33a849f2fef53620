#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "format/api.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// A file, or what stands for one, of which any part can be read: for assets that are too large to be read
/// whole.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Fills `to` with the bytes from `offset` on; `offset` + `to.size()` must be at most size() (assert).
  /// Errors: kUnreadable, also where the file has become shorter.
  [[nodiscard]] virtual Status read(std::uint64_t offset, std::span<std::byte> to) = 0;
};

/// A file on disk that is open for reading.
class FileSource final : public ByteSource {
 public:
  /// Errors: kUnreadable (missing, a folder, a pipe or device, no permission).
  [[nodiscard]] static Result<FileSource> open(const std::string& path);
  FileSource(FileSource&& other) noexcept;
  FileSource& operator=(FileSource&& other) noexcept;
  ~FileSource() override;

  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] Status read(std::uint64_t offset, std::span<std::byte> to) override;
  /// How many bytes were read so far.
  [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  FileSource() = default;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t bytes_read_ = 0;
};

/// Bytes in memory, which must outlive it.
class SpanSource final : public ByteSource {
 public:
  explicit SpanSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] Status read(std::uint64_t offset, std::span<std::byte> to) override;

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace mesocell
