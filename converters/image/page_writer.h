#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/result.h"

namespace mesocell {

enum class PageSampleType : std::uint8_t {
  kUint8,
  kUint16,
  kUint32,
  kFloat,
  kSrgb8,  ///< colors; all others are numbers
};

/// Bytes of a sample.
[[nodiscard]] std::size_t page_sample_bytes(PageSampleType type);

/// Pictures of one size, page after page: rows from the top, channels interleaved.
struct PageStack {
  std::uint32_t width = 0, height = 0, pages = 1;
  std::vector<std::string> channels;  ///< "Y", or "R", "G", "B"
  PageSampleType type = PageSampleType::kUint8;
  std::span<const std::byte> samples = {};  ///< of the machine's byte order
};

/// Whether such pictures can be written under that name: .png (one page; 8 or 16 bits), .tif and .tiff (any),
/// .exr (floats). Errors: kUsage.
[[nodiscard]] Status check_page_path(const std::string& path, PageSampleType type, std::uint32_t pages);

/// The bytes of the file; the same pictures give the same ones. Errors: kUsage, kOutput, kLimit.
[[nodiscard]] Result<std::vector<std::byte>> encode_pages(const std::string& path, const PageStack& stack);

}  // namespace mesocell
