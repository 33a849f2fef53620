#pragma once

#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mesocell {

/// The `size` bytes at `offset`, which must be there (assert). Sizes in a file have 64 bits on every machine.
template <typename Byte>
[[nodiscard]] std::span<Byte> slice(std::span<Byte> bytes, std::uint64_t offset, std::uint64_t size) {
  assert(offset <= bytes.size() && size <= bytes.size() - offset);
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
}

/// A bounded cursor over little-endian bytes. Untrusted input: safe. A read beyond the end returns 0 (or an
/// empty span), leaves the position where it was and sets overrun(), which never goes back.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }
  [[nodiscard]] bool overrun() const { return overrun_; }

  std::span<const std::byte> take(std::uint64_t count) {
    if (count > remaining()) {
      overrun_ = true;
      return {};
    }
    const auto taken = slice(bytes_, position_, count);
    position_ += taken.size();
    return taken;
  }
  void skip(std::uint64_t count) { (void)take(count); }

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(number(8)); }

 private:
  std::uint64_t number(unsigned count) {
    const auto taken = take(count);
    std::uint64_t v = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) v |= std::to_integer<std::uint64_t>(taken[i]) << (8 * i);
    return v;
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool overrun_ = false;
};

/// The offset of the first byte that is not zero, or bytes.size().
[[nodiscard]] inline std::size_t first_nonzero(std::span<const std::byte> bytes) {
  std::size_t i = 0;
  while (i < bytes.size() && bytes[i] == std::byte{0}) ++i;
  return i;
}

}  // namespace mesocell
