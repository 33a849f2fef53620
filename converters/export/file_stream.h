#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/file.h"

namespace mesocell {

/// Writes a file in pieces, through an AtomicFile. The first error stays, and finish() returns it.
class FileStream {
 public:
  [[nodiscard]] static Result<FileStream> create(const std::string& path, bool no_clobber) {
    Result<AtomicFile> file = AtomicFile::create(path, no_clobber);
    if (!file) return file.error();
    return FileStream(std::move(*file));
  }

  void text(std::string_view s) { append(s.data(), s.size()); }
  /// The shortest digits that give the same number again.
  template <typename T>
  void number(T value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    (void)error;  // 24 characters are the most
    append(digits, std::size_t(end - digits));
  }
  /// Little-endian.
  void u16(std::uint16_t v) { integer(v, 2); }
  void u32(std::uint32_t v) { integer(v, 4); }
  void f32(float v) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    integer(bits, 4);
  }
  void f64(double v) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    integer(bits, 8);
  }
  void u8(std::uint8_t v) { append(&v, 1); }
  void bytes(std::span<const std::byte> b) { append(b.data(), b.size()); }

  /// Whether writing still makes sense.
  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] std::uint64_t size() const { return written_ + buffer_.size(); }
  /// Gives the file its name. At most once.
  [[nodiscard]] Status finish() {
    flush();
    return status_ ? file_.commit() : status_;
  }

 private:
  static constexpr std::size_t kBuffer = std::size_t{1} << 20;

  explicit FileStream(AtomicFile file) : file_(std::move(file)) { buffer_.reserve(kBuffer); }
  void integer(std::uint64_t v, std::size_t count) {
    std::byte b[8];
    for (std::size_t k = 0; k < count; ++k) b[k] = std::byte(v >> (8 * k) & 0xff);
    append(b, count);
  }
  void append(const void* data, std::size_t count) {
    const auto* p = static_cast<const std::byte*>(data);
    if (buffer_.size() + count > kBuffer) flush();
    if (count > kBuffer) {
      if (status_) status_ = file_.write({p, count});
      written_ += count;
    } else {
      buffer_.insert(buffer_.end(), p, p + count);
    }
  }
  void flush() {
    if (status_ && !buffer_.empty()) status_ = file_.write(buffer_);
    written_ += buffer_.size();
    buffer_.clear();
  }

  AtomicFile file_;
  std::vector<std::byte> buffer_;
  std::uint64_t written_ = 0;
  Status status_;
};

}  // namespace mesocell
