#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/block_table.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace mesocell {

/// No zstd block of b bytes makes more than 128 KiB, and none has fewer than 4 bytes: a chunk that promises
/// more is refused before anything is allocated for it. [spec 3.6; RFC 8878, 3.1.1.2]
inline constexpr std::uint64_t kMaxZstdRatio = 32768;
/// Largest window of a frame, bytes: what every zstd decoder must offer. [RFC 8878, 3.1.1.1.2]
inline constexpr int kMaxZstdWindowLog = 23;
inline constexpr std::uint64_t kMaxZstdWindow = std::uint64_t{1} << kMaxZstdWindowLog;

/// Compresses blocks, each as one zstd frame with content size and without checksum, on one thread: the same
/// bytes each time.
class ZstdCompressor {
 public:
  /// `chunk_bytes`: how much is going to be compressed in all, by which the level is chosen. Throws
  /// std::bad_alloc, for callers in format/ to catch; so does compress().
  explicit ZstdCompressor(std::uint64_t chunk_bytes);
  ~ZstdCompressor();
  ZstdCompressor(const ZstdCompressor&) = delete;
  ZstdCompressor& operator=(const ZstdCompressor&) = delete;

  /// Appends the frame, or the bytes themselves if they are no more.
  void compress(std::span<const std::byte> bytes, std::vector<std::byte>& to);

 private:
  ZSTD_CCtx_s* context_;
};

/// Decodes blocks, one after the other.
class ZstdDecompressor {
 public:
  ZstdDecompressor() = default;
  ~ZstdDecompressor();
  ZstdDecompressor(const ZstdDecompressor&) = delete;
  ZstdDecompressor& operator=(const ZstdDecompressor&) = delete;

  /// Decodes the one frame that `block.bytes` must be, to exactly `to`; reports to the sink if it is not.
  /// Untrusted input: safe. Throws std::bad_alloc if there is no memory for zstd's state of some 160 KiB, for
  /// callers in format/ to catch.
  [[nodiscard]] bool decompress(const ChunkPayload& block, std::span<std::byte> to, IssueSink& sink);

 private:
  ZSTD_DCtx_s* context_ = nullptr;
};

}  // namespace mesocell
