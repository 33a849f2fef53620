#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <vector>

#include "format/api.h"
#include "format/block_table.h"
#include "format/byte_source.h"
#include "format/codec.h"
#include "format/container_scan.h"
#include "format/limits.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// Reads header, asset table and directory of a file in one go, or two if there are more than some 60 chunks.
/// Untrusted input: safe. Errors: those of the source, kInvalidInput with the id, kLimit.
[[nodiscard]] Result<ContainerScan> read_head(ByteSource& source, const ReadLimits& limits);

/// Parts of a chunk's payload, read block by block. Each block's hash is checked, and blocks are kept while
/// there is room for them. Untrusted input: safe.
class ChunkReader {
 public:
  /// The source must outlive it; `chunk` is usable, by a scan of the same source.
  ChunkReader(ByteSource& source, const ChunkInfo& chunk) : source_(&source), chunk_(chunk) {}

  [[nodiscard]] const ChunkInfo& chunk() const { return chunk_; }
  /// Bytes of the payload; `begin` + `to.size()` must be at most decoded_bytes (assert). Errors: those of the
  /// source, kInvalidInput, kLimit (no memory).
  [[nodiscard]] Status read(std::uint64_t begin, std::span<std::byte> to);

 private:
  struct Block {
    std::uint64_t index = 0;
    std::vector<std::byte> bytes;
  };
  static constexpr std::size_t kKept = 4;

  [[nodiscard]] Result<const Block*> block(std::uint64_t index);
  [[nodiscard]] Status load(Block& block);

  ByteSource* source_;
  ChunkInfo chunk_;
  std::list<Block> kept_;  ///< last used first
};

}  // namespace mesocell
