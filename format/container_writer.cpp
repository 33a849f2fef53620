#include <algorithm>
#include <bit>
#include <cassert>
#include <new>
#include <optional>
#include <utility>

#include "format/block_table.h"
#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/codec.h"
#include "format/container.h"
#include "format/hash.h"
#include "format/representation.h"
#include "format/utf8.h"

namespace mesocell {
namespace {

using std::to_string;

/// Cuts a chunk into blocks, each compressed if that is asked for and makes it smaller, and puts their table
/// before them. [spec 3.5] `info` has the decoded size and the block size, and gets the rest.
std::vector<std::byte> store(std::span<const std::byte> bytes, bool compress, ChunkInfo& info) {
  std::optional<ZstdCompressor> compressor;
  if (compress) compressor.emplace(bytes.size());
  std::vector<std::byte> blocks;
  ByteWriter out;
  const std::uint64_t count = info.block_count();
  for (std::uint64_t b = 0; b < count; ++b) {
    const auto block = slice(bytes, b * info.block_bytes, block_decoded_bytes(info, b));
    const std::size_t begin = blocks.size();
    if (compressor) {
      compressor->compress(block, blocks);
    } else {
      blocks.insert(blocks.end(), block.begin(), block.end());
    }
    if (count == 1) break;
    out.u64(blocks.size());
    out.u64(hash64(std::span(blocks).subspan(begin)));
  }
  info.codec = compress ? kCodecZstd : kCodecRaw;
  info.hash = hash64(count > 1 ? out.bytes() : blocks);
  out.pad_to(kChunkAlignment);
  out.append(blocks);
  info.stored_bytes = out.size();
  return out.release();
}

/// Compressed if that makes the file smaller.
std::vector<std::byte> store_best(std::span<const std::byte> bytes, bool compress, ChunkInfo& info) {
  if (compress) {
    std::vector<std::byte> stored = store(bytes, true, info);
    if (padded(stored.size()) < padded(block_data_at(info) + bytes.size())) return stored;
  }
  return store(bytes, false, info);
}

/// Stored bytes of each block.
std::vector<std::uint64_t> stored_sizes(std::span<const std::byte> stored, const ChunkInfo& info) {
  if (info.block_count() <= 1) return {stored.size()};
  std::vector<std::uint64_t> sizes;
  std::uint64_t begin = 0;
  for (std::uint64_t b = 0; b < info.block_count(); ++b) {
    const std::uint64_t end = block_row(stored, b).end;
    sizes.push_back(end - std::exchange(begin, end));
  }
  return sizes;
}

}  // namespace

void ContainerWriter::begin_asset(std::uint32_t representation, std::string_view name) try {
  assets_.push_back({representation, std::string(name), 0});
} catch (const std::bad_alloc&) {
  out_of_memory_ = true;
}

void ContainerWriter::add_chunk(std::uint32_t type, Importance importance, std::span<const std::byte> bytes,
                                std::uint32_t block_bytes, const BlocksFit& fits) try {
  assert(std::has_single_bit(block_bytes) && block_bytes >= kMinBlockBytes && block_bytes <= kMaxBlockBytes);
  if (out_of_memory_) return;
  assert(!assets_.empty());
  assert(std::none_of(chunks_.end() - std::ptrdiff_t(assets_.back().chunk_count), chunks_.end(),
                      [&](const Chunk& c) { return c.info.type == type; }));
  Chunk chunk;
  chunk.info.type = type;
  chunk.info.critical = importance == Importance::kCritical;
  chunk.info.block_bytes = block_bytes;
  chunk.info.decoded_bytes = bytes.size();
  chunk.stored = store_best(bytes, options_.compress, chunk.info);
  while (fits && chunk.info.block_bytes > kMinBlockBytes &&
         !fits(chunk.info.block_bytes, stored_sizes(chunk.stored, chunk.info))) {
    chunk.info.block_bytes /= 2;
    chunk.stored = store_best(bytes, options_.compress, chunk.info);
  }
  chunks_.push_back(std::move(chunk));
  ++assets_.back().chunk_count;
} catch (const std::bad_alloc&) {
  out_of_memory_ = true;
}

std::uint16_t ContainerWriter::least_minor() const {
  std::uint16_t minor = 0;
  std::size_t chunk = 0;
  for (const Asset& asset : assets_) {
    const Representation* const rules = find_representation(asset.representation);
    for (std::uint32_t i = 0; i < asset.chunk_count; ++i, ++chunk) {
      const ChunkRule* const rule =
          rules ? rules->find(chunks_[chunk].info.type, options_.version.minor) : nullptr;
      if (rule) minor = std::max(minor, rule->minor);
    }
  }
  return minor;
}

Result<std::vector<std::byte>> ContainerWriter::finish() try {
  if (out_of_memory_) return out_of_memory();
  assert(!assets_.empty());
  if (options_.version.major != kFormatMajor || options_.version.minor > kFormatMinor)
    return Error{ErrorCode::kUsage, "there is no version " + to_string(options_.version.major) + "." +
                                        to_string(options_.version.minor) +
                                        " of the format; 1.0 and 1.1 can be written"};
  if (assets_.size() > kMaxAssets) return Error{ErrorCode::kLimit, "a file has at most 1024 assets"};
  if (chunks_.size() > kMaxChunks) return Error{ErrorCode::kLimit, "a file has at most 4096 chunks"};

  ByteWriter tables;
  for (std::size_t i = 0; i < assets_.size(); ++i) {
    const Asset& asset = assets_[i];
    assert(asset.chunk_count > 0);
    if (asset.name.size() > kMaxNameBytes || asset.name.find('\0') != std::string::npos ||
        !is_utf8(asset.name))
      return Error{ErrorCode::kUsage,
                   "the name of an asset must be UTF-8 of at most 40 bytes, none of them zero", "asset-name"};
    if (!asset.name.empty() && std::any_of(assets_.begin(), assets_.begin() + std::ptrdiff_t(i),
                                           [&](const Asset& other) { return other.name == asset.name; }))
      return Error{ErrorCode::kUsage, "two assets have the name '" + asset.name + "'",
                   "asset-name-duplicate"};
    tables.u32(asset.representation);
    tables.u32(0);
    tables.u32(asset.chunk_count);
    tables.u32(0);
    tables.append(asset.name);
    tables.zeros(kMaxNameBytes - asset.name.size() + 8);
  }
  std::uint64_t offset = kHeaderBytes + assets_.size() * kAssetBytes + chunks_.size() * kEntryBytes;
  for (const Chunk& chunk : chunks_) {
    tables.u32(chunk.info.type);
    tables.u32(chunk.info.critical ? kCriticalFlag : 0);
    tables.u32(chunk.info.codec);
    tables.u32(chunk.info.block_bytes);
    tables.u64(offset);
    tables.u64(chunk.info.stored_bytes);
    tables.u64(chunk.info.decoded_bytes);
    tables.u64(chunk.info.hash);
    tables.zeros(16);
    offset += padded(chunk.stored.size());
  }

  ByteWriter out;
  out.reserve(static_cast<std::size_t>(offset));
  out.append(std::as_bytes(std::span(kMagic)));
  out.u16(options_.version.major);
  out.u16(least_minor());
  out.u32(static_cast<std::uint32_t>(assets_.size()));
  out.u64(offset);
  out.u32(static_cast<std::uint32_t>(chunks_.size()));
  out.u32(0);
  out.u64(hash64(tables.bytes()));
  out.zeros(16);
  out.u64(hash64(out.bytes()));
  out.append(tables.bytes());
  for (const Chunk& chunk : chunks_) {
    out.append(chunk.stored);
    out.pad_to(kChunkAlignment);
  }
  return out.release();
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace mesocell
