#include "format/container_scan.h"

#include <algorithm>
#include <string>

#include "format/block_table.h"
#include "format/byte_reader.h"
#include "format/fourcc.h"
#include "format/hash.h"
#include "format/representation.h"
#include "format/utf8.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::size_t kHashedHeaderBytes = 56;
constexpr std::size_t kAssetCountAt = 12;
constexpr std::size_t kChunkCountAt = 24;

struct Counts {
  std::uint32_t assets = 0;
  std::uint32_t chunks = 0;
};

/// Bytes that must be zero in a file of this version, and that a later one may use for what readers of this
/// one can ignore. [spec 5]
void check_ignorable(const ContainerScan& scan, std::span<const std::byte> bytes, std::uint64_t at,
                     std::uint32_t chunk, IssueSink& sink) {
  if (scan.minor > kFormatMinor) return;
  if (const std::size_t i = first_nonzero(bytes); i < bytes.size())
    sink.add(IssueId::kExtensionNonzero, at + i, chunk);
}

/// Header, [spec 3.1]. Empty if the tables cannot be reached.
std::optional<Counts> scan_header(std::span<const std::byte> head, std::uint64_t file_bytes,
                                  ContainerScan& scan, std::uint64_t& tables_hash, IssueSink& sink) {
  const std::size_t magic_bytes = std::min(head.size(), kMagic.size());
  for (std::size_t i = 0; i < magic_bytes; ++i) {
    if (std::to_integer<unsigned>(head[i]) == kMagic[i]) continue;
    sink.add(IssueId::kHeaderMagic, i, 0);
    return std::nullopt;
  }
  if (head.size() < kHeaderBytes) {
    sink.add(IssueId::kHeaderTruncated, head.size(), 0, "it has " + to_string(head.size()));
    return std::nullopt;
  }
  ByteReader in(head.first(kHeaderBytes));
  in.skip(kMagic.size());
  scan.major = in.u16();
  scan.minor = in.u16();
  Counts counts;
  counts.assets = in.u32();
  scan.file_bytes = in.u64();
  counts.chunks = in.u32();
  const std::uint32_t flags = in.u32();
  tables_hash = in.u64();
  const auto reserved = in.take(8);
  const auto ignorable = in.take(8);
  const std::uint64_t header_hash = in.u64();

  // The hash comes first: a damaged version is not a version.
  if (header_hash != hash64(head.first(kHashedHeaderBytes))) sink.add(IssueId::kHeaderHash, 56, 0);
  const std::string version = to_string(scan.major) + "." + to_string(scan.minor);
  if (scan.major != kFormatMajor) {
    sink.add(IssueId::kVersionUnsupported, 8, 0,
             version + " instead of " + to_string(kFormatMajor) + "." + to_string(kFormatMinor));
    return std::nullopt;  // what follows may mean anything there
  }
  if (scan.minor > kFormatMinor) sink.add(IssueId::kVersionNewer, 10, 0, version);
  if (scan.file_bytes != file_bytes) {
    sink.add(IssueId::kFileSize, 16, 0,
             "it has " + to_string(file_bytes) + " instead of " + to_string(scan.file_bytes) + " bytes");
  }
  if (flags != 0) sink.add(IssueId::kHeaderFlags, 28, 0);
  if (const std::size_t i = first_nonzero(reserved); i < reserved.size())
    sink.add(IssueId::kHeaderReserved, 40 + i, 0);
  check_ignorable(scan, ignorable, 48, 0, sink);
  const bool assets_ok = counts.assets >= 1 && counts.assets <= kMaxAssets;
  const bool chunks_ok = counts.chunks >= 1 && counts.chunks <= kMaxChunks;
  if (!assets_ok) sink.add(IssueId::kAssetCount, kAssetCountAt, 0, to_string(counts.assets));
  if (!chunks_ok) sink.add(IssueId::kChunkCount, kChunkCountAt, 0, to_string(counts.chunks));
  if (!assets_ok || !chunks_ok) return std::nullopt;
  if (const std::uint64_t needed = head_bytes(head); needed > head.size()) {
    sink.add(IssueId::kDirectoryTruncated, head.size(), 0,
             "header, asset table and directory have " + to_string(needed) + " bytes");
    return std::nullopt;
  }
  return counts;
}

/// One row of the asset table, [spec 3.2].
void scan_asset_row(std::span<const std::byte> head, std::size_t index, ContainerScan& scan,
                    std::uint64_t& next_chunk, IssueSink& sink) {
  const std::uint64_t at = kHeaderBytes + index * kAssetBytes;
  ByteReader in(slice(head, at, kAssetBytes));
  AssetInfo asset;
  asset.representation = in.u32();
  asset.rules = find_representation(asset.representation);
  const std::uint32_t flags = in.u32();
  asset.chunk_count = in.u32();
  const auto reserved = in.take(4);
  const auto name = in.take(kMaxNameBytes);
  const auto ignorable = in.take(8);

  if ((flags & kMustKnowFlags) != 0) sink.add(IssueId::kAssetFlags, at + 4, 0, to_string(flags));
  if (flags > kMustKnowFlags && scan.minor <= kFormatMinor)
    sink.add(IssueId::kExtensionNonzero, at + 4, 0, "flags " + to_string(flags));
  if (const std::size_t i = first_nonzero(reserved); i < reserved.size())
    sink.add(IssueId::kAssetReserved, at + 12 + i, 0);
  check_ignorable(scan, ignorable, at + 56, 0, sink);

  const auto end = std::find(name.begin(), name.end(), std::byte{0});
  asset.name.assign(reinterpret_cast<const char*>(name.data()), static_cast<std::size_t>(end - name.begin()));
  const auto tail = name.subspan(asset.name.size());
  if (const std::size_t i = first_nonzero(tail); i < tail.size() || !is_utf8(asset.name)) {
    sink.add(IssueId::kAssetName, at + 16, 0);
    asset.name.clear();
  }
  const bool taken =
      !asset.name.empty() && std::any_of(scan.assets.begin(), scan.assets.end(),
                                         [&](const AssetInfo& other) { return other.name == asset.name; });
  if (taken) sink.add(IssueId::kAssetNameDuplicate, at + 16, 0);

  asset.first_chunk = static_cast<std::uint32_t>(std::min<std::uint64_t>(next_chunk, kMaxChunks));
  next_chunk += asset.chunk_count;
  scan.assets.push_back(std::move(asset));
}

/// Whether a chunk's sizes fit its codec and its blocks. [spec 3.3, 3.5]
bool check_sizes(const ChunkInfo& chunk, std::uint64_t at, IssueSink& sink) {
  const auto sizes = [&] {
    return to_string(chunk.stored_bytes) + " stored, " + to_string(chunk.decoded_bytes) + " decoded bytes";
  };
  bool ok = true;
  if (chunk.block_bytes < kMinBlockBytes || chunk.block_bytes > kMaxBlockBytes ||
      (chunk.block_bytes & (chunk.block_bytes - 1)) != 0) {
    sink.add(IssueId::kBlockBytes, at + 12, chunk.type, to_string(chunk.block_bytes));
    ok = false;
  }
  if (chunk.codec != kCodecRaw && chunk.codec != kCodecZstd) {
    sink.add(IssueId::kChunkCodec, at + 8, chunk.type, to_string(chunk.codec));
    ok = false;
  }
  if (!ok) return false;
  const std::uint64_t data_at = block_data_at(chunk);
  // Every block has at least one byte, so a table that is in the file bounds the number of blocks.
  if (data_at > chunk.stored_bytes) {
    sink.add(IssueId::kBlockTable, at + 24, chunk.type, sizes());
    return false;
  }
  if (chunk.codec == kCodecRaw && chunk.stored_bytes - data_at != chunk.decoded_bytes) {
    sink.add(IssueId::kChunkRawSize, at + 24, chunk.type, sizes());
    return false;
  }
  if (chunk.block_count() > 1) return true;
  return check_block_size(chunk, 0, chunk.stored_bytes, at + 24, sink);
}

/// One directory entry, [spec 3.3]. `expected` is where the chunk must begin, and then where the next one
/// must.
void scan_entry(std::span<const std::byte> head, std::uint64_t at, std::uint64_t file_bytes,
                std::uint64_t& expected, ContainerScan& scan, IssueSink& sink) {
  ByteReader in(slice(head, at, kEntryBytes));
  ChunkInfo chunk;
  chunk.type = in.u32();
  const std::uint32_t flags = in.u32();
  chunk.critical = (flags & kCriticalFlag) != 0;
  chunk.codec = in.u32();
  chunk.block_bytes = in.u32();
  chunk.offset = in.u64();
  chunk.stored_bytes = in.u64();
  chunk.decoded_bytes = in.u64();
  chunk.hash = in.u64();
  const auto reserved = in.take(8);
  const auto ignorable = in.take(8);

  if ((flags & kMustKnowFlags & ~kCriticalFlag) != 0)
    sink.add(IssueId::kChunkFlags, at + 4, chunk.type, to_string(flags));
  if (flags > kMustKnowFlags && scan.minor <= kFormatMinor)
    sink.add(IssueId::kExtensionNonzero, at + 4, chunk.type, "flags " + to_string(flags));
  if (const std::size_t i = first_nonzero(reserved); i < reserved.size())
    sink.add(IssueId::kChunkReserved, at + 48 + i, chunk.type);
  check_ignorable(scan, ignorable, at + 56, chunk.type, sink);
  if (chunk.offset != expected) {
    sink.add(IssueId::kChunkOffset, at + 16, chunk.type,
             to_string(chunk.offset) + " instead of " + to_string(expected));
  }
  bool usable = check_sizes(chunk, at, sink);
  if (chunk.offset > file_bytes || chunk.stored_bytes > file_bytes - chunk.offset) {
    sink.add(IssueId::kChunkBounds, at + 24, chunk.type,
             to_string(chunk.stored_bytes) + " bytes at " + to_string(chunk.offset) + " of " +
                 to_string(file_bytes));
    usable = false;
    expected = file_bytes;
  } else {
    const std::uint64_t end = chunk.offset + chunk.stored_bytes;
    const std::uint64_t padding = (kChunkAlignment - end % kChunkAlignment) % kChunkAlignment;
    if (padding > file_bytes - end) {
      sink.add(IssueId::kChunkBounds, end, chunk.type, "the file ends in the padding after it");
      usable = false;
    }
    expected = end + std::min(padding, file_bytes - end);
  }
  scan.chunks.push_back(chunk);
  scan.usable.push_back(usable);
}

}  // namespace

std::optional<std::size_t> ContainerScan::find(std::size_t asset, std::uint32_t type) const {
  const AssetInfo& info = assets[asset];
  for (std::size_t i = info.first_chunk; i < std::size_t{info.first_chunk} + info.chunk_count; ++i)
    if (chunks[i].type == type) return i;
  return std::nullopt;
}

std::uint64_t head_bytes(std::span<const std::byte> header) {
  ByteReader in(header);
  in.skip(kAssetCountAt);
  const std::uint64_t assets = std::min(in.u32(), kMaxAssets);
  in.skip(kChunkCountAt - kAssetCountAt - 4);
  const std::uint64_t chunks = std::min(in.u32(), kMaxChunks);
  return kHeaderBytes + assets * kAssetBytes + chunks * kEntryBytes;
}

std::optional<ContainerScan> scan_container(std::span<const std::byte> head, std::uint64_t file_bytes,
                                            const ReadLimits& limits, IssueSink& sink) {
  if (file_bytes > limits.max_file_bytes) {
    sink.add(
        IssueId::kLimitExceeded, std::nullopt, 0,
        "the file has " + to_string(file_bytes) + " bytes, the limit is " + to_string(limits.max_file_bytes));
    return std::nullopt;
  }
  ContainerScan scan;
  std::uint64_t tables_hash = 0;
  const auto counts = scan_header(head, file_bytes, scan, tables_hash, sink);
  if (!counts || sink.stopped()) return std::nullopt;
  const std::uint64_t directory_at = kHeaderBytes + counts->assets * std::uint64_t{kAssetBytes};
  const std::uint64_t tables_end = directory_at + counts->chunks * std::uint64_t{kEntryBytes};
  if (tables_hash != hash64(slice(head, kHeaderBytes, tables_end - kHeaderBytes)))
    sink.add(IssueId::kDirectoryHash, 32, 0);

  std::uint64_t next_chunk = 0;
  bool assets_ok = true;
  for (std::uint32_t i = 0; i < counts->assets && !sink.stopped(); ++i) {
    scan_asset_row(head, i, scan, next_chunk, sink);
    if (scan.assets.back().chunk_count == 0) {
      sink.add(IssueId::kAssetChunkCount, kHeaderBytes + i * kAssetBytes + 8, 0, "it has none");
      assets_ok = false;
    }
  }
  if (sink.stopped()) return std::nullopt;
  if (next_chunk != counts->chunks) {
    sink.add(IssueId::kAssetChunkCount, kHeaderBytes + 8, 0,
             to_string(next_chunk) + " in sum instead of " + to_string(counts->chunks));
    assets_ok = false;
  }
  std::uint64_t expected = tables_end;
  for (std::uint32_t i = 0; i < counts->chunks && !sink.stopped(); ++i)
    scan_entry(head, directory_at + i * std::uint64_t{kEntryBytes}, file_bytes, expected, scan, sink);
  if (sink.stopped()) return std::nullopt;
  if (expected < file_bytes)
    sink.add(IssueId::kFileTrailing, expected, 0, to_string(file_bytes - expected) + " bytes");
  if (sink.stopped() || !assets_ok) return std::nullopt;
  return scan;
}

bool scan_asset(const ContainerScan& scan, std::size_t asset, IssueSink& sink) {
  const AssetInfo& info = scan.assets[asset];
  if (!info.rules) {
    sink.add(IssueId::kRepresentationUnknown, kHeaderBytes + asset * kAssetBytes, 0,
             "'" + fourcc_text(info.representation) + "'");
  }
  const std::size_t end = std::size_t{info.first_chunk} + info.chunk_count;
  for (std::size_t i = info.first_chunk; i < end && !sink.stopped(); ++i) {
    const std::uint64_t at = scan.entry_at(i);
    const ChunkInfo& chunk = scan.chunks[i];
    if (*scan.find(asset, chunk.type) != i) {
      sink.add(IssueId::kChunkDuplicate, at, chunk.type);
      continue;
    }
    if (!info.rules) continue;
    const ChunkRule* rule = info.rules->find(chunk.type, scan.minor);
    if (!rule) {
      sink.add(chunk.critical ? IssueId::kChunkUnknownCritical : IssueId::kChunkUnknownSkippable, at,
               chunk.type, "'" + fourcc_text(chunk.type) + "'");
    } else if (rule->critical != chunk.critical) {
      sink.add(IssueId::kChunkCriticality, at + 4, chunk.type);
    } else if (rule->raw && chunk.codec != kCodecRaw) {
      sink.add(IssueId::kChunkCodec, at + 8, chunk.type, "this one must be raw");
    }
  }
  if (!info.rules) return false;
  for (const ChunkRule& rule : info.rules->chunks) {
    if (rule.required && !sink.stopped() && !scan.find(asset, rule.type))
      sink.add(IssueId::kChunkMissing, std::nullopt, rule.type, "'" + fourcc_text(rule.type) + "'");
  }
  return true;
}

bool charge_asset(const ContainerScan& scan, std::size_t asset, MemoryBudget& budget, IssueSink& sink) {
  const AssetInfo& info = scan.assets[asset];
  for (std::size_t i = 0; i < info.chunk_count; ++i) {
    const ChunkInfo& chunk = scan.chunks[info.first_chunk + i];
    // What an unusable chunk states is not going to be allocated.
    if (!scan.usable[info.first_chunk + i] || budget.charge(chunk.decoded_bytes)) continue;
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type,
             "the chunks of the asset decode to more bytes than the limit");
    return false;
  }
  return true;
}

}  // namespace mesocell
