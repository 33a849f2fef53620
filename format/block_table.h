#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "format/api.h"
#include "format/container_scan.h"
#include "format/payload.h"

/// How a chunk is stored: in blocks that decode alone, and if there are several behind a table of them.
/// [spec 3.5]
namespace mesocell MESOCELL_API {

class ZstdDecompressor;

inline constexpr std::size_t kBlockRowBytes = 16;

/// Bytes with the zeros that follow them, up to where the next chunk may begin. [spec 3.4]
[[nodiscard]] constexpr std::uint64_t padded(std::uint64_t bytes) {
  return (bytes + kChunkAlignment - 1) / kChunkAlignment * kChunkAlignment;
}

/// Where a chunk's first block begins, from the chunk's offset: after the table, if it has one.
[[nodiscard]] std::uint64_t block_data_at(const ChunkInfo& chunk);

/// Decoded bytes of block `block`.
[[nodiscard]] std::uint64_t block_decoded_bytes(const ChunkInfo& chunk, std::uint64_t block);

/// Whether a block of this many stored bytes can be block `block`: at least one byte, no more than it decodes
/// to, and no fewer than its codec needs. Reports at `at` if not. A chunk without bytes has one block of none
/// here.
[[nodiscard]] bool check_block_size(const ChunkInfo& chunk, std::uint64_t block, std::uint64_t stored_bytes,
                                    std::uint64_t at, IssueSink& sink);

/// A row of a block table, as it stands there.
struct BlockRow {
  std::uint64_t end = 0;   ///< where the block ends, from where the first one begins
  std::uint64_t hash = 0;  ///< of the block's stored bytes
};
[[nodiscard]] BlockRow block_row(std::span<const std::byte> table, std::uint64_t block);

/// Checks all hashes of a usable chunk, its block table and the padding in it and after it. False if the
/// chunk cannot be decoded or the sink is stopped. Untrusted input: safe.
[[nodiscard]] bool verify_chunk(std::span<const std::byte> file, const ContainerScan& scan, std::size_t index,
                                IssueSink& sink);

/// Decodes a chunk that verify_chunk() found right, to `to` of decoded_bytes. Untrusted input: safe.
[[nodiscard]] bool decode_chunk(std::span<const std::byte> file, const ChunkInfo& chunk,
                                std::span<std::byte> to, IssueSink& sink);

/// Decodes one block that has the right size and hash, to `to` of its decoded size; `at` is where it begins
/// in the file. Untrusted input: safe.
[[nodiscard]] bool decode_block(const ChunkInfo& chunk, std::span<const std::byte> stored,
                                std::span<std::byte> to, std::uint64_t at, ZstdDecompressor& zstd,
                                IssueSink& sink);

}  // namespace mesocell
