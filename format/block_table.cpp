#include "format/block_table.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "format/byte_reader.h"
#include "format/codec.h"
#include "format/fourcc.h"
#include "format/hash.h"

namespace mesocell {
namespace {

using std::to_string;

void check_padding(std::span<const std::byte> padding, std::uint64_t at, std::uint32_t type,
                   IssueSink& sink) {
  if (const std::size_t i = first_nonzero(padding); i < padding.size())
    sink.add(IssueId::kPaddingNonzero, at + i, type);
}

/// The table and every block of a chunk of several. `stored` are the chunk's bytes.
bool verify_blocks(std::span<const std::byte> stored, const ChunkInfo& chunk, IssueSink& sink) {
  const std::uint64_t count = chunk.block_count();
  const auto table = slice(stored, 0, count * kBlockRowBytes);
  if (hash64(table) != chunk.hash) {
    sink.add(IssueId::kChunkHash, chunk.offset, chunk.type, "that of its block table");
    return false;
  }
  const std::uint64_t data_at = block_data_at(chunk);
  check_padding(slice(stored, table.size(), data_at - table.size()), chunk.offset + table.size(), chunk.type,
                sink);
  bool ok = true;
  const auto data = slice(stored, data_at, stored.size() - data_at);
  std::uint64_t begin = 0;
  for (std::uint64_t b = 0; b < count && !sink.stopped(); ++b) {
    const BlockRow row = block_row(table, b);
    const std::uint64_t row_at = chunk.offset + b * kBlockRowBytes;
    if (row.end < begin || row.end > data.size()) {
      sink.add(IssueId::kBlockSize, row_at, chunk.type,
               "block " + to_string(b) + " ends at " + to_string(row.end) + " of " + to_string(data.size()));
      return false;  // where the next one begins is not known
    }
    ok &= check_block_size(chunk, b, row.end - begin, row_at, sink);
    if (hash64(slice(data, begin, row.end - begin)) != row.hash) {
      ok = false;
      if (sink.wants(IssueId::kBlockHash))
        sink.add(IssueId::kBlockHash, chunk.offset + data_at + begin, chunk.type, "block " + to_string(b));
    }
    begin = row.end;
  }
  if (!sink.stopped() && begin != data.size()) {
    sink.add(IssueId::kBlockSize, chunk.offset + data_at + begin, chunk.type,
             to_string(data.size() - begin) + " bytes after the last block");
    ok = false;
  }
  return ok && !sink.stopped();
}

}  // namespace

std::uint64_t block_data_at(const ChunkInfo& chunk) {
  const std::uint64_t count = chunk.block_count();
  return count > 1 ? padded(count * kBlockRowBytes) : 0;
}

std::uint64_t block_decoded_bytes(const ChunkInfo& chunk, std::uint64_t block) {
  return std::min<std::uint64_t>(chunk.block_bytes, chunk.decoded_bytes - block * chunk.block_bytes);
}

bool check_block_size(const ChunkInfo& chunk, std::uint64_t block, std::uint64_t stored_bytes,
                      std::uint64_t at, IssueSink& sink) {
  const std::uint64_t decoded = block_decoded_bytes(chunk, block);
  const bool right = chunk.codec == kCodecRaw ? stored_bytes == decoded
                                              : stored_bytes <= decoded && (stored_bytes > 0 || decoded == 0);
  if (!right) {
    sink.add(IssueId::kBlockSize, at, chunk.type,
             "block " + to_string(block) + ": " + to_string(stored_bytes) + " stored, " + to_string(decoded) +
                 " decoded bytes");
    return false;
  }
  if (decoded / kMaxZstdRatio > stored_bytes) {
    sink.add(
        IssueId::kBlockRatio, at, chunk.type,
        "block " + to_string(block) + ": " + to_string(decoded) + " bytes from " + to_string(stored_bytes));
    return false;
  }
  return true;
}

BlockRow block_row(std::span<const std::byte> table, std::uint64_t block) {
  ByteReader in(slice(table, block * kBlockRowBytes, kBlockRowBytes));
  BlockRow row;
  row.end = in.u64();
  row.hash = in.u64();
  return row;
}

bool verify_chunk(std::span<const std::byte> file, const ContainerScan& scan, std::size_t index,
                  IssueSink& sink) {
  const ChunkInfo& chunk = scan.chunks[index];
  const auto stored = slice(file, chunk.offset, chunk.stored_bytes);
  bool ok = true;
  if (chunk.block_count() > 1) {
    ok = verify_blocks(stored, chunk, sink);
  } else if (hash64(stored) != chunk.hash) {
    sink.add(IssueId::kChunkHash, chunk.offset, chunk.type, "'" + fourcc_text(chunk.type) + "'");
    ok = false;
  }
  const std::uint64_t end = chunk.offset + chunk.stored_bytes;
  if (!sink.stopped()) check_padding(slice(file, end, padded(end) - end), end, chunk.type, sink);
  return ok && !sink.stopped();
}

bool decode_chunk(std::span<const std::byte> file, const ChunkInfo& chunk, std::span<std::byte> to,
                  IssueSink& sink) {
  const auto stored = slice(file, chunk.offset, chunk.stored_bytes);
  const std::uint64_t count = chunk.block_count();
  const std::uint64_t data_at = block_data_at(chunk);
  ZstdDecompressor zstd;
  std::uint64_t begin = 0;
  for (std::uint64_t b = 0; b < count; ++b) {
    const std::uint64_t end = count > 1 ? block_row(stored, b).end : stored.size();
    if (!decode_block(chunk, slice(stored, data_at + begin, end - begin),
                      slice(to, b * chunk.block_bytes, block_decoded_bytes(chunk, b)),
                      chunk.offset + data_at + begin, zstd, sink))
      return false;
    begin = end;
  }
  return true;
}

bool decode_block(const ChunkInfo& chunk, std::span<const std::byte> stored, std::span<std::byte> to,
                  std::uint64_t at, ZstdDecompressor& zstd, IssueSink& sink) {
  if (stored.size() != to.size()) return zstd.decompress({chunk.type, stored, at, true}, to, sink);
  if (!to.empty()) std::memcpy(to.data(), stored.data(), to.size());
  return true;
}

}  // namespace mesocell
