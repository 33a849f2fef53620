#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace mesocell {

/// Appends little-endian numbers to a growing array.
class ByteWriter {
 public:
  void u8(std::uint8_t v) { number(v, 1); }
  void u16(std::uint16_t v) { number(v, 2); }
  void u32(std::uint32_t v) { number(v, 4); }
  void u64(std::uint64_t v) { number(v, 8); }
  void f32(float v) { u32(std::bit_cast<std::uint32_t>(v)); }
  void f64(double v) { number(std::bit_cast<std::uint64_t>(v), 8); }
  void zeros(std::uint64_t count) { bytes_.resize(bytes_.size() + static_cast<std::size_t>(count)); }
  void append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void append(std::string_view text) { append(std::as_bytes(std::span(text))); }
  /// Zeros up to the next multiple of `alignment`.
  void pad_to(std::uint64_t alignment) { zeros((alignment - bytes_.size() % alignment) % alignment); }
  void reserve(std::uint64_t count) { bytes_.reserve(static_cast<std::size_t>(count)); }

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  [[nodiscard]] std::vector<std::byte> release() { return std::move(bytes_); }

 private:
  void number(std::uint64_t v, unsigned count) {
    for (unsigned i = 0; i < count; ++i) bytes_.push_back(static_cast<std::byte>(v >> (8 * i) & 0xff));
  }

  std::vector<std::byte> bytes_;
};

}  // namespace mesocell
