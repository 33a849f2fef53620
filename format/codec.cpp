#include "format/codec.h"

#include <zstd.h>
#include <zstd_errors.h>

#include <new>
#include <string>

#include "format/byte_reader.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kFrameMagic = 0xFD2FB528;
/// By measuring Voronoi tiles of 128³ voxels with 8 and 64 cells: level 12 makes 42 and 99 kB in 0.04 s,
/// level 17 39 and 83 kB in 0.2 s, level 19 29 and 63 kB in 1 s, and 22 hardly less. Tiles are written once
/// and read often, so the best level that keeps writing at a few seconds is taken; all decode equally fast.
/// Levels 5 to 10 are not to be taken: what zstd 1.5.4 makes of 16 to 128 KiB by them hangs on whether the
/// machine has vector instructions.
int level_for(std::uint64_t bytes) {
  if (bytes <= std::uint64_t{4} << 20) return 19;
  return bytes <= std::uint64_t{64} << 20 ? 17 : 13;
}

/// Smaller blocks stay raw: a frame's tables eat most of what it saves, and the bytes do not hang on the
/// version of the zstd library.
constexpr std::size_t kSmallestCompressed = 256;

struct FrameHeader {
  std::uint64_t content_size = 0;
  std::uint64_t window_size = 0;
};

/// Reads the header of a zstd frame [RFC 8878, 3.1.1.1]; empty if it is not one that the format allows.
/// zstd's own function for this is not part of its stable interface.
std::optional<FrameHeader> parse_frame_header(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  if (in.u32() != kFrameMagic) return std::nullopt;
  const unsigned descriptor = in.u8();
  const unsigned size_flag = descriptor >> 6;
  const bool single_segment = (descriptor >> 5 & 1) != 0;
  const bool reserved = (descriptor >> 3 & 1) != 0;
  const unsigned dictionary_flag = descriptor & 3;
  if (reserved || dictionary_flag != 0) return std::nullopt;
  if (size_flag == 0 && !single_segment) return std::nullopt;

  FrameHeader header;
  if (!single_segment) {
    const unsigned window = in.u8();
    const std::uint64_t base = std::uint64_t{1} << (10 + (window >> 3));
    header.window_size = base + base / 8 * (window & 7);
  }
  switch (size_flag) {
    case 0:
      header.content_size = in.u8();
      break;
    case 1:
      header.content_size = std::uint64_t{in.u16()} + 256;
      break;
    case 2:
      header.content_size = in.u32();
      break;
    default:
      header.content_size = in.u64();
      break;
  }
  if (in.overrun()) return std::nullopt;
  if (single_segment) header.window_size = header.content_size;
  return header;
}

}  // namespace

ZstdCompressor::ZstdCompressor(std::uint64_t chunk_bytes) : context_(ZSTD_createCCtx()) {
  if (!context_) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context_, ZSTD_c_compressionLevel, level_for(chunk_bytes));
  ZSTD_CCtx_setParameter(context_, ZSTD_c_windowLog, kMaxZstdWindowLog);
  ZSTD_CCtx_setParameter(context_, ZSTD_c_contentSizeFlag, 1);
  ZSTD_CCtx_setParameter(context_, ZSTD_c_checksumFlag, 0);
}

ZstdCompressor::~ZstdCompressor() { ZSTD_freeCCtx(context_); }

void ZstdCompressor::compress(std::span<const std::byte> bytes, std::vector<std::byte>& to) {
  const std::size_t begin = to.size();
  if (bytes.size() >= kSmallestCompressed) {
    const std::size_t room = ZSTD_compressBound(bytes.size());
    to.resize(begin + room);
    const std::size_t size = ZSTD_compress2(context_, to.data() + begin, room, bytes.data(), bytes.size());
    // With room for the worst case, lack of memory is all that can go wrong.
    if (ZSTD_isError(size) != 0) throw std::bad_alloc();
    to.resize(begin + size);
    if (size < bytes.size()) return;
    to.resize(begin);
  }
  to.insert(to.end(), bytes.begin(), bytes.end());
}

ZstdDecompressor::~ZstdDecompressor() { ZSTD_freeDCtx(context_); }

bool ZstdDecompressor::decompress(const ChunkPayload& block, std::span<std::byte> to, IssueSink& sink) {
  const auto fail = [&](IssueId id, std::string detail) {
    sink.add(id, block.file_offset, block.type, std::move(detail));
    return false;
  };
  const auto header = parse_frame_header(block.bytes);
  if (!header) return fail(IssueId::kZstdFrame, "its frame header is not one of those");
  if (header->content_size != to.size()) {
    return fail(IssueId::kZstdSize,
                std::to_string(header->content_size) + " instead of " + std::to_string(to.size()) + " bytes");
  }
  if (header->window_size > kMaxZstdWindow)
    return fail(IssueId::kZstdWindow, std::to_string(header->window_size) + " bytes");
  const std::size_t frame_bytes = ZSTD_findFrameCompressedSize(block.bytes.data(), block.bytes.size());
  if (ZSTD_isError(frame_bytes) != 0) return fail(IssueId::kZstdData, "the frame does not end in the block");
  if (frame_bytes != block.bytes.size()) {
    return fail(IssueId::kZstdFrame, "the frame ends " + std::to_string(block.bytes.size() - frame_bytes) +
                                         " bytes before the block");
  }
  if (!context_) context_ = ZSTD_createDCtx();
  if (!context_) throw std::bad_alloc();
  const std::size_t size =
      ZSTD_decompressDCtx(context_, to.data(), to.size(), block.bytes.data(), block.bytes.size());
  if (ZSTD_isError(size) != 0) {
    if (ZSTD_getErrorCode(size) == ZSTD_error_memory_allocation) throw std::bad_alloc();
    return fail(IssueId::kZstdData, ZSTD_getErrorName(size));
  }
  if (size != to.size()) return fail(IssueId::kZstdData, "it makes " + std::to_string(size) + " bytes");
  return true;
}

}  // namespace mesocell
