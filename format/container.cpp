#include "format/container.h"

#include <cassert>
#include <new>
#include <string>

#include "format/block_table.h"
#include "format/fourcc.h"

namespace mesocell {
Result<Container> Container::open(std::span<const std::byte> file, const ReadLimits& limits) try {
  IssueSink sink = IssueSink::first_error();
  auto scan = scan_container(file, file.size(), limits, sink);
  if (!scan || sink.errors() > 0) return sink.first_error_as_result();
  Container container;
  container.file_ = file;
  container.scan_ = std::move(*scan);
  container.limits_ = limits;
  return container;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

std::span<const ChunkInfo> Container::chunks_of(std::size_t asset) const {
  assert(asset < scan_.assets.size());
  return chunks().subspan(scan_.assets[asset].first_chunk, scan_.assets[asset].chunk_count);
}

Status Container::verify(std::size_t asset) const try {
  assert(asset < scan_.assets.size());
  IssueSink sink = IssueSink::first_error();
  if (!scan_asset(scan_, asset, sink) || sink.errors() > 0) return sink.first_error_as_result();
  const AssetInfo& info = scan_.assets[asset];
  for (std::size_t i = 0; i < info.chunk_count; ++i)
    if (!verify_chunk(file_, scan_, info.first_chunk + i, sink)) return sink.first_error_as_result();
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::vector<std::byte>> Container::read_chunk(std::size_t asset, std::uint32_t type) const try {
  assert(asset < scan_.assets.size());
  IssueSink sink = IssueSink::first_error();
  const auto index = scan_.find(asset, type);
  if (!index) {
    sink.add(IssueId::kChunkMissing, std::nullopt, type, "'" + fourcc_text(type) + "'");
    return sink.first_error_as_result();
  }
  const ChunkInfo& chunk = scan_.chunks[*index];
  if (MemoryBudget budget(limits_); !budget.charge(chunk.decoded_bytes)) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, type, std::to_string(chunk.decoded_bytes) + " bytes");
    return sink.first_error_as_result();
  }
  if (!verify_chunk(file_, scan_, *index, sink)) return sink.first_error_as_result();
  std::vector<std::byte> decoded(static_cast<std::size_t>(chunk.decoded_bytes));
  if (!decode_chunk(file_, chunk, decoded, sink)) return sink.first_error_as_result();
  return decoded;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace mesocell
