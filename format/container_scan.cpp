#include "format/container_scan.h"

#include <algorithm>
#include <string>

#include "format/byte_reader.h"
#include "format/codec.h"
#include "format/fourcc.h"
#include "format/hash.h"
#include "format/representation.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::size_t kHashedHeaderBytes = 56;

/// Header, [spec 3.1]. Returns the number of chunks, 0 if the directory cannot be reached.
std::uint32_t scan_header(std::span<const std::byte> file, ContainerScan& scan, std::uint64_t& directory_hash,
                          IssueSink& sink) {
  const std::size_t magic_bytes = std::min(file.size(), kMagic.size());
  for (std::size_t i = 0; i < magic_bytes; ++i) {
    if (std::to_integer<unsigned>(file[i]) == kMagic[i]) continue;
    sink.add(IssueId::kHeaderMagic, i, 0);
    return 0;
  }
  if (file.size() < kHeaderBytes) {
    sink.add(IssueId::kHeaderTruncated, file.size(), 0, "it has " + to_string(file.size()));
    return 0;
  }
  ByteReader in(file.first(kHeaderBytes));
  in.skip(kMagic.size());
  scan.major = in.u16();
  scan.minor = in.u16();
  scan.representation = in.u32();
  scan.file_bytes = in.u64();
  const std::uint32_t chunk_count = in.u32();
  const std::uint32_t flags = in.u32();
  directory_hash = in.u64();
  const auto reserved = in.take(16);
  const std::uint64_t header_hash = in.u64();
  scan.rules = find_representation(scan.representation);

  // The hash comes first: a damaged version is not a version.
  if (header_hash != hash64(file.first(kHashedHeaderBytes))) sink.add(IssueId::kHeaderHash, 56, 0);
  if (scan.major != kFormatMajor || scan.minor != kFormatMinor) {
    sink.add(IssueId::kVersionUnsupported, 8, 0,
             to_string(scan.major) + "." + to_string(scan.minor) + " instead of " + to_string(kFormatMajor) +
                 "." + to_string(kFormatMinor));
    return 0;  // what follows may mean anything there
  }
  if (!scan.rules)
    sink.add(IssueId::kRepresentationUnknown, 12, 0, "'" + fourcc_text(scan.representation) + "'");
  if (scan.file_bytes != file.size()) {
    sink.add(IssueId::kFileSize, 16, 0,
             "it has " + to_string(file.size()) + " instead of " + to_string(scan.file_bytes) + " bytes");
  }
  if (flags != 0) sink.add(IssueId::kHeaderFlags, 28, 0);
  if (const std::size_t i = first_nonzero(reserved); i < reserved.size())
    sink.add(IssueId::kHeaderReserved, 40 + i, 0);
  if (chunk_count == 0 || chunk_count > kMaxChunks) {
    sink.add(IssueId::kChunkCount, 24, 0, to_string(chunk_count));
    return 0;
  }
  if (chunk_count > (file.size() - kHeaderBytes) / kEntryBytes) {
    sink.add(IssueId::kDirectoryTruncated, file.size(), 0,
             "it needs " + to_string(chunk_count * kEntryBytes) + " bytes after the header");
    return 0;
  }
  return chunk_count;
}

/// One directory entry, [spec 3.2]; true if the chunk can be looked into. `expected` is where the chunk must
/// begin, and then where the next one must.
bool scan_entry(std::span<const std::byte> file, std::uint64_t at, std::uint64_t& expected,
                ContainerScan& scan, IssueSink& sink) {
  ByteReader in(file.subspan(at, kEntryBytes));
  ChunkInfo chunk;
  chunk.type = in.u32();
  const std::uint32_t flags = in.u32();
  chunk.critical = (flags & kCriticalFlag) != 0;
  chunk.codec = in.u32();
  const auto reserved = in.take(4);
  chunk.offset = in.u64();
  chunk.stored_bytes = in.u64();
  chunk.decoded_bytes = in.u64();
  const std::uint64_t hash = in.u64();
  const auto tail = in.take(16);

  bool usable = true;
  if (flags > kCriticalFlag) sink.add(IssueId::kChunkFlags, at + 4, chunk.type);
  if (chunk.codec != kCodecRaw && chunk.codec != kCodecZstd) {
    sink.add(IssueId::kChunkCodec, at + 8, chunk.type, to_string(chunk.codec));
    usable = false;
  }
  if (const std::size_t i = first_nonzero(reserved); i < reserved.size())
    sink.add(IssueId::kChunkReserved, at + 12 + i, chunk.type);
  if (const std::size_t i = first_nonzero(tail); i < tail.size())
    sink.add(IssueId::kChunkReserved, at + 48 + i, chunk.type);
  if (chunk.offset != expected) {
    sink.add(IssueId::kChunkOffset, at + 16, chunk.type,
             to_string(chunk.offset) + " instead of " + to_string(expected));
  }
  if (chunk.codec == kCodecRaw && chunk.stored_bytes != chunk.decoded_bytes) {
    sink.add(IssueId::kChunkRawSize, at + 24, chunk.type,
             to_string(chunk.stored_bytes) + " and " + to_string(chunk.decoded_bytes));
    usable = false;
  }
  if (chunk.codec == kCodecZstd && chunk.decoded_bytes / kMaxZstdRatio > chunk.stored_bytes) {
    sink.add(IssueId::kChunkRatio, at + 32, chunk.type,
             to_string(chunk.decoded_bytes) + " from " + to_string(chunk.stored_bytes));
    usable = false;
  }
  if (chunk.offset > file.size() || chunk.stored_bytes > file.size() - chunk.offset) {
    sink.add(IssueId::kChunkBounds, at + 16, chunk.type,
             to_string(chunk.stored_bytes) + " bytes at " + to_string(chunk.offset) + " of " +
                 to_string(file.size()));
    usable = false;
    expected = file.size();
  } else {
    const std::uint64_t end = chunk.offset + chunk.stored_bytes;
    expected = end + (kChunkAlignment - end % kChunkAlignment) % kChunkAlignment;
  }
  scan.chunks.push_back(chunk);
  scan.hashes.push_back(hash);
  return usable;
}

/// Which chunk types are there, [spec 3.2, 4]: by the representation's rules alone.
void scan_types(ContainerScan& scan, IssueSink& sink) {
  for (std::size_t i = 0; i < scan.chunks.size() && !sink.stopped(); ++i) {
    const std::uint64_t at = kHeaderBytes + i * kEntryBytes;
    const ChunkInfo& chunk = scan.chunks[i];
    if (*scan.find(chunk.type) != i) {
      sink.add(IssueId::kChunkDuplicate, at, chunk.type);
      continue;
    }
    if (!scan.rules) continue;
    const ChunkRule* rule = scan.rules->find(chunk.type);
    if (!rule) {
      sink.add(chunk.critical ? IssueId::kChunkUnknownCritical : IssueId::kChunkUnknownSkippable, at,
               chunk.type, "'" + fourcc_text(chunk.type) + "'");
    } else if (rule->critical != chunk.critical) {
      sink.add(IssueId::kChunkCriticality, at + 4, chunk.type);
    }
  }
  if (!scan.rules) return;
  for (const ChunkRule& rule : scan.rules->chunks) {
    if (rule.required && !scan.find(rule.type))
      sink.add(IssueId::kChunkMissing, std::nullopt, rule.type, "'" + fourcc_text(rule.type) + "'");
  }
}

/// Padding after every chunk and the end of the file, [spec 3.3].
void scan_padding(std::span<const std::byte> file, const ContainerScan& scan, std::uint64_t end,
                  IssueSink& sink) {
  for (std::size_t i = 0; i < scan.chunks.size() && !sink.stopped(); ++i) {
    const ChunkInfo& chunk = scan.chunks[i];
    if (chunk.offset > file.size() || chunk.stored_bytes > file.size() - chunk.offset) continue;
    const std::uint64_t begin = chunk.offset + chunk.stored_bytes;
    const std::uint64_t wanted = (kChunkAlignment - begin % kChunkAlignment) % kChunkAlignment;
    if (wanted > file.size() - begin) {
      sink.add(IssueId::kChunkBounds, begin, chunk.type, "the file ends in the padding after it");
      continue;
    }
    const auto padding = file.subspan(begin, wanted);
    if (const std::size_t at = first_nonzero(padding); at < padding.size())
      sink.add(IssueId::kPaddingNonzero, begin + at, chunk.type);
  }
  if (end < file.size()) sink.add(IssueId::kFileTrailing, end, 0, to_string(file.size() - end) + " bytes");
}

}  // namespace

std::optional<std::size_t> ContainerScan::find(std::uint32_t type) const {
  const auto at =
      std::find_if(chunks.begin(), chunks.end(), [&](const ChunkInfo& c) { return c.type == type; });
  if (at == chunks.end()) return std::nullopt;
  return static_cast<std::size_t>(at - chunks.begin());
}

std::optional<ContainerScan> scan_container(std::span<const std::byte> file, const ReadLimits& limits,
                                            MemoryBudget& budget, IssueSink& sink) {
  if (file.size() > limits.max_file_bytes) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, 0,
             "the file has " + to_string(file.size()) + " bytes, the limit is " +
                 to_string(limits.max_file_bytes));
    return std::nullopt;
  }
  ContainerScan scan;
  std::uint64_t directory_hash = 0;
  const std::uint32_t chunk_count = scan_header(file, scan, directory_hash, sink);
  if (chunk_count == 0 || sink.stopped()) return std::nullopt;
  const auto directory = file.subspan(kHeaderBytes, chunk_count * kEntryBytes);
  if (directory_hash != hash64(directory)) sink.add(IssueId::kDirectoryHash, 32, 0);

  std::uint64_t expected = kHeaderBytes + directory.size();
  for (std::uint32_t i = 0; i < chunk_count && !sink.stopped(); ++i)
    scan.usable.push_back(scan_entry(file, kHeaderBytes + i * kEntryBytes, expected, scan, sink));
  if (sink.stopped()) return std::nullopt;
  scan_types(scan, sink);
  scan_padding(file, scan, expected, sink);

  for (const ChunkInfo& chunk : scan.chunks) {
    if (scan.over_limit || budget.charge(chunk.decoded_bytes)) continue;
    scan.over_limit = true;
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type,
             "the chunks decode to more than " + to_string(limits.max_decoded_bytes) + " bytes");
  }
  if (sink.stopped()) return std::nullopt;
  return scan;
}

bool verify_chunk(std::span<const std::byte> file, const ContainerScan& scan, std::size_t index,
                  IssueSink& sink) {
  const ChunkInfo& chunk = scan.chunks[index];
  if (hash64(file.subspan(chunk.offset, chunk.stored_bytes)) == scan.hashes[index]) return true;
  sink.add(IssueId::kChunkHash, chunk.offset, chunk.type, "'" + fourcc_text(chunk.type) + "'");
  return false;
}

std::optional<std::vector<std::byte>> decode_chunk(std::span<const std::byte> file, const ContainerScan& scan,
                                                   std::size_t index, IssueSink& sink) {
  const ChunkInfo& chunk = scan.chunks[index];
  const auto stored = file.subspan(chunk.offset, chunk.stored_bytes);
  if (chunk.codec == kCodecRaw) return std::vector<std::byte>(stored.begin(), stored.end());
  return decompress_zstd({chunk.type, stored, chunk.offset, true}, chunk.decoded_bytes, sink);
}

void add_issue(IssueSink& sink, IssueId id, const ChunkPayload& chunk, std::size_t at, std::string detail) {
  if (chunk.raw) {
    sink.add(id, chunk.file_offset + at, chunk.type, std::move(detail));
    return;
  }
  // The byte has no place of its own in a compressed chunk.
  if (!detail.empty()) detail += ", ";
  detail += "at byte " + to_string(at) + " of the decoded chunk";
  sink.add(id, chunk.file_offset, chunk.type, std::move(detail));
}

}  // namespace mesocell
