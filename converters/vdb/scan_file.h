#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "converters/import/read_notes.h"
#include "converters/vdb/sparse_volume.h"
#include "format/result.h"

namespace mesocell {

struct ScanReadOptions {
  std::uint64_t max_voxels = std::uint64_t{1} << 28;
};

/// What the head of a scan says of the numbers that follow.
struct ScanHead {
  enum class Number : std::uint8_t { kU8, kI8, kU16, kI16, kFloat };
  std::string format;  ///< "MetaImage" or "INRIMAGE-4"
  std::array<std::uint32_t, 3> size{};
  Number number = Number::kU8;
  bool big_endian = false;
  Transform index_to_world;
  std::string data_file;            ///< a name without folders; empty if the numbers follow the head
  std::size_t data_at = 0;          ///< where they begin
  std::vector<std::string> unused;  ///< names of what else the head says
  [[nodiscard]] std::uint64_t voxel_count() const { return std::uint64_t{size[0]} * size[1] * size[2]; }
  [[nodiscard]] std::uint64_t number_bytes() const {
    return number == Number::kFloat ? 4 : number == Number::kU8 || number == Number::kI8 ? 1 : 2;
  }
};

/// The extensions of scans, for messages and help texts.
inline constexpr const char* kScanExtensions = ".mhd, .mha, .inr";

/// Whether a path has one of them, any case.
[[nodiscard]] bool has_scan_extension(const std::string& path);

/// Parses the head of a MetaImage or an INRIMAGE-4, told by what it begins with. Untrusted input: safe.
/// Errors: kInvalidInput, kLimit.
[[nodiscard]] Result<ScanHead> parse_scan_head(std::span<const std::byte> bytes,
                                               const ScanReadOptions& options = {});

/// Reads a scan, samples of a scalar in a box: a MetaImage, whose numbers follow its head or are in a file
/// beside it, or an INRIMAGE-4. Of 3 dimensions and one channel, uncompressed, numbers of 8 or 16 bits or
/// floats; with spacing and offset, axes that are turned are refused. The first sample is at the offset;
/// beyond the samples all is as the least of them. `notes`: the file beside
/// it, and what else the head says.
/// Untrusted input: safe; the size of the file is checked before memory is taken. Errors: kUnreadable,
/// kInvalidInput, kLimit.
[[nodiscard]] Result<SparseVolume> read_scan(const std::string& path, const ScanReadOptions& options = {},
                                             ReadNotes* notes = nullptr);

}  // namespace mesocell
