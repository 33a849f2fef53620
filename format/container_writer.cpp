#include <algorithm>
#include <cassert>
#include <new>
#include <utility>

#include "format/byte_writer.h"
#include "format/codec.h"
#include "format/container.h"
#include "format/hash.h"

namespace mesocell {

void ContainerWriter::add_chunk(std::uint32_t type, Importance importance,
                                std::span<const std::byte> bytes) try {
  assert(std::none_of(chunks_.begin(), chunks_.end(), [&](const Chunk& c) { return c.type == type; }));
  Chunk chunk;
  chunk.type = type;
  chunk.importance = importance;
  chunk.decoded_bytes = bytes.size();
  if (auto compressed = compress_zstd(bytes)) {
    chunk.codec = kCodecZstd;
    chunk.stored = std::move(*compressed);
  } else {
    chunk.codec = kCodecRaw;
    chunk.stored.assign(bytes.begin(), bytes.end());
  }
  chunks_.push_back(std::move(chunk));
} catch (const std::bad_alloc&) {
  out_of_memory_ = true;
}

Result<std::vector<std::byte>> ContainerWriter::finish(std::uint32_t representation) try {
  assert(!chunks_.empty() || out_of_memory_);
  if (out_of_memory_) return Error{ErrorCode::kLimit, "there is not enough memory to compress the file"};
  if (chunks_.size() > kMaxChunks) return Error{ErrorCode::kLimit, "a file has at most 1024 chunks"};

  const auto padded = [](std::uint64_t bytes) {
    return (bytes + kChunkAlignment - 1) / kChunkAlignment * kChunkAlignment;
  };
  ByteWriter directory;
  std::uint64_t offset = kHeaderBytes + chunks_.size() * kEntryBytes;
  for (const Chunk& chunk : chunks_) {
    directory.u32(chunk.type);
    directory.u32(chunk.importance == Importance::kCritical ? kCriticalFlag : 0);
    directory.u32(chunk.codec);
    directory.u32(0);
    directory.u64(offset);
    directory.u64(chunk.stored.size());
    directory.u64(chunk.decoded_bytes);
    directory.u64(hash64(chunk.stored));
    directory.zeros(16);
    offset += padded(chunk.stored.size());
  }

  ByteWriter out;
  out.reserve(offset);
  out.append(std::as_bytes(std::span(kMagic)));
  out.u16(kFormatMajor);
  out.u16(kFormatMinor);
  out.u32(representation);
  out.u64(offset);
  out.u32(static_cast<std::uint32_t>(chunks_.size()));
  out.u32(0);
  out.u64(hash64(directory.bytes()));
  out.zeros(16);
  out.u64(hash64(out.bytes()));
  out.append(directory.bytes());
  for (const Chunk& chunk : chunks_) {
    out.append(chunk.stored);
    out.pad_to(kChunkAlignment);
  }
  return out.release();
} catch (const std::bad_alloc&) {
  return Error{ErrorCode::kLimit, "there is not enough memory to write the file"};
}

}  // namespace mesocell
