#include "format/chunk_reader.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <new>

#include "format/byte_reader.h"
#include "format/hash.h"

namespace mesocell {
namespace {

/// What one read at the beginning of a file takes: a page.
constexpr std::uint64_t kFirstRead = 4096;

}  // namespace

Result<ContainerScan> read_head(ByteSource& source, const ReadLimits& limits) try {
  std::vector<std::byte> head(static_cast<std::size_t>(std::min(source.size(), kFirstRead)));
  if (Status status = source.read(0, head); !status) return status.error();
  if (head.size() >= kHeaderBytes) {
    const std::uint64_t wanted = std::min(source.size(), head_bytes(head));
    if (const std::size_t have = head.size(); wanted > have) {
      head.resize(static_cast<std::size_t>(wanted));
      if (Status status = source.read(have, std::span(head).subspan(have)); !status) return status.error();
    }
  }
  IssueSink sink = IssueSink::first_error();
  auto scan = scan_container(head, source.size(), limits, sink);
  if (!scan || sink.errors() > 0) return sink.first_error_as_result();
  return std::move(*scan);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Status ChunkReader::read(std::uint64_t begin, std::span<std::byte> to) try {
  assert(begin <= chunk_.decoded_bytes && to.size() <= chunk_.decoded_bytes - begin);
  while (!to.empty()) {
    const Result<const Block*> found = block(begin / chunk_.block_bytes);
    if (!found) return found.error();
    const auto from =
        std::span((*found)->bytes).subspan(static_cast<std::size_t>(begin % chunk_.block_bytes));
    const std::size_t count = std::min(from.size(), to.size());
    std::copy_n(from.begin(), count, to.begin());
    to = to.subspan(count);
    begin += count;
  }
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<const ChunkReader::Block*> ChunkReader::block(std::uint64_t index) {
  const auto at = std::find_if(kept_.begin(), kept_.end(), [&](const Block& b) { return b.index == index; });
  if (at != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, at);
    return &kept_.front();
  }
  Block loaded;
  loaded.index = index;
  if (Status status = load(loaded); !status) return status.error();
  kept_.push_front(std::move(loaded));
  if (kept_.size() > kKept) kept_.pop_back();
  return &kept_.front();
}

Status ChunkReader::load(Block& block) {
  IssueSink sink = IssueSink::first_error();
  std::uint64_t begin = 0, end = chunk_.stored_bytes, hash = chunk_.hash;
  const std::uint64_t data_at = block_data_at(chunk_), room = chunk_.stored_bytes - data_at;
  if (chunk_.block_count() > 1) {
    // The block's row, and the one before it, which says where it begins.
    std::array<std::byte, 2 * kBlockRowBytes> rows{};
    const bool is_first = block.index == 0;
    const auto wanted = std::span(rows).subspan(is_first ? kBlockRowBytes : 0);
    const std::uint64_t row_at = chunk_.offset + (block.index - (is_first ? 0 : 1)) * kBlockRowBytes;
    if (Status status = source_->read(row_at, wanted); !status) return status.error();
    const BlockRow row = block_row(rows, 1);
    begin = block_row(rows, 0).end;
    end = row.end;
    hash = row.hash;
    if (end < begin || end > room) {
      sink.add(IssueId::kBlockSize, row_at, chunk_.type, "block " + std::to_string(block.index));
      return sink.first_error_as_result();
    }
    if (!check_block_size(chunk_, block.index, end - begin, row_at, sink))
      return sink.first_error_as_result();
  }
  std::vector<std::byte> stored(static_cast<std::size_t>(end - begin));
  const std::uint64_t at = chunk_.offset + data_at + begin;
  if (Status status = source_->read(at, stored); !status) return status.error();
  if (hash64(stored) != hash) {
    sink.add(chunk_.block_count() > 1 ? IssueId::kBlockHash : IssueId::kChunkHash, at, chunk_.type);
    return sink.first_error_as_result();
  }
  block.bytes.resize(static_cast<std::size_t>(block_decoded_bytes(chunk_, block.index)));
  ZstdDecompressor zstd;
  if (!decode_block(chunk_, stored, block.bytes, at, zstd, sink)) return sink.first_error_as_result();
  return {};
}

}  // namespace mesocell
