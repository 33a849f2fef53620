#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/container_scan.h"

namespace mesocell {

/// No zstd block of b bytes makes more than 128 KiB, and none has fewer than 4 bytes: a chunk that promises
/// more is refused before anything is allocated for it. [spec 3.4; RFC 8878, 3.1.1.2]
inline constexpr std::uint64_t kMaxZstdRatio = 32768;
/// Largest window of a frame, bytes: what every zstd decoder must offer. [RFC 8878, 3.1.1.1.2]
inline constexpr int kMaxZstdWindowLog = 23;
inline constexpr std::uint64_t kMaxZstdWindow = std::uint64_t{1} << kMaxZstdWindowLog;

/// Compresses as one zstd frame with content size and without checksum, on one thread: the same bytes each
/// time. Empty if that does not make the file smaller. Throws std::bad_alloc, for its callers in format/ to
/// catch.
[[nodiscard]] std::optional<std::vector<std::byte>> compress_zstd(std::span<const std::byte> bytes);

/// Decodes the one frame that `chunk.bytes` must be, to exactly `decoded_bytes`; reports to the sink and is
/// then empty. Untrusted input: safe; nothing is allocated before the frame's header has been checked.
[[nodiscard]] std::optional<std::vector<std::byte>> decompress_zstd(const ChunkPayload& chunk,
                                                                    std::uint64_t decoded_bytes,
                                                                    IssueSink& sink);

}  // namespace mesocell
