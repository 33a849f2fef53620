#include "converters/image/exr_check.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace mesocell {
namespace {

/// Of names, with the zero at their end.
constexpr std::size_t kMaxName = 256;
constexpr std::uint32_t kMaxParts = 1024, kMaxAttributes = 4096;
/// Of coordinates; sums with sizes then fit an int.
constexpr std::int64_t kFarthest = 1 << 30;

/// Reads what stands one after another in a file.
class Cursor {
 public:
  Cursor(const InputFile& file, std::uint64_t at) : file_(file), at_(at) {}

  /// A little-endian number; nothing if the file ends before.
  std::optional<std::uint32_t> number() {
    std::array<std::byte, 4> raw{};
    if (!file_.read_at(at_, raw)) return std::nullopt;
    at_ += raw.size();
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value |= std::uint32_t(raw[k]) << (8 * k);
    return value;
  }
  /// A text that ends with a zero; nothing if it has no end.
  std::optional<std::string> text() {
    std::array<std::byte, kMaxName> raw{};
    const std::size_t bytes = std::size_t(std::min<std::uint64_t>(kMaxName, file_.size() - at_));
    if (!file_.read_at(at_, std::span(raw).first(bytes))) return std::nullopt;
    const auto end = std::find(raw.begin(), raw.begin() + bytes, std::byte{0});
    if (end == raw.begin() + bytes) return std::nullopt;
    const std::size_t length = std::size_t(end - raw.begin());
    at_ += length + 1;
    return std::string(reinterpret_cast<const char*>(raw.data()), length);
  }
  /// False if the file ends before.
  bool skip(std::uint64_t bytes) {
    if (bytes > file_.size() - at_) return false;
    at_ += bytes;
    return true;
  }

 private:
  const InputFile& file_;
  std::uint64_t at_;  ///< at most the file's size
};

Error damaged() {
  return Error{ErrorCode::kInvalidInput, "its header is damaged or cut off; fetch or export it again"};
}

Status check_side(std::int64_t side, std::uint32_t max_side) {
  if (side <= 0) return damaged();
  if (side > max_side)
    return Error{ErrorCode::kLimit, "it or its tiles have a side of " + std::to_string(side) +
                                        " pixels, over the limit of " + std::to_string(max_side) +
                                        "; make it smaller"};
  return {};
}

/// Checks an attribute's value, on which the cursor stands.
Status check_value(Cursor cursor, const std::string& name, std::uint32_t max_side) {
  if (name == "dataWindow") {
    std::array<std::int64_t, 4> corner{};
    for (std::int64_t& value : corner) {
      const std::optional<std::uint32_t> number = cursor.number();
      if (!number) return damaged();
      value = std::int32_t(*number);
      if (value > kFarthest || value < -kFarthest) return damaged();
    }
    for (std::size_t a = 0; a < 2; ++a)
      if (Status status = check_side(corner[a + 2] - corner[a] + 1, max_side); !status) return status;
  }
  if (name == "tiles")
    for (int a = 0; a < 2; ++a) {
      const std::optional<std::uint32_t> side = cursor.number();
      if (!side) return damaged();
      if (Status status = check_side(*side, max_side); !status) return status;
    }
  return {};
}

}  // namespace

Status check_exr(const InputFile& file, std::uint32_t max_side) {
  if (file.size() < 8) return damaged();
  Cursor cursor(file, 4);
  const std::optional<std::uint32_t> version = cursor.number();
  if (!version) return damaged();
  const bool many = (*version & 0x1000) != 0;
  for (std::uint32_t part = 0; part <= kMaxParts; ++part) {
    bool has_window = false;
    for (std::uint32_t k = 0;; ++k) {
      const std::optional<std::string> name = cursor.text();
      if (!name || k > kMaxAttributes) return damaged();
      if (name->empty()) {
        // An empty header ends those of a file of several parts.
        if (many && part > 0 && k == 0) return {};
        break;
      }
      const std::optional<std::string> type = cursor.text();
      const std::optional<std::uint32_t> bytes = type ? cursor.number() : std::nullopt;
      if (!bytes) return damaged();
      const Cursor value = cursor;
      if (!cursor.skip(*bytes)) return damaged();
      if (Status status = check_value(value, *name, max_side); !status) return status;
      has_window = has_window || *name == "dataWindow";
    }
    if (!has_window) return damaged();
    if (!many) return {};
  }
  return Error{ErrorCode::kLimit, "it has more than " + std::to_string(kMaxParts) + " parts; take fewer"};
}

}  // namespace mesocell
