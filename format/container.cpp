#include "format/container.h"

#include <new>
#include <string>

#include "format/fourcc.h"

namespace mesocell {
namespace {

Error no_memory() { return Error{ErrorCode::kLimit, "there is not enough memory", "limit-exceeded"}; }

}  // namespace

Result<Container> Container::open(std::span<const std::byte> file, const ReadLimits& limits) try {
  IssueSink sink = IssueSink::first_error();
  MemoryBudget budget(limits);
  auto scan = scan_container(file, limits, budget, sink);
  if (!scan || sink.errors() > 0) return sink.first_error_as_result();
  Container container;
  container.file_ = file;
  container.scan_ = std::move(*scan);
  return container;
} catch (const std::bad_alloc&) {
  return no_memory();
}

Status Container::verify() const {
  IssueSink sink = IssueSink::first_error();
  for (std::size_t i = 0; i < scan_.chunks.size(); ++i)
    if (!verify_chunk(file_, scan_, i, sink)) return sink.first_error_as_result();
  return {};
}

Result<std::vector<std::byte>> Container::read_chunk(std::uint32_t type) const try {
  IssueSink sink = IssueSink::first_error();
  const auto index = scan_.find(type);
  if (!index) {
    sink.add(IssueId::kChunkMissing, std::nullopt, type, "'" + fourcc_text(type) + "'");
    return sink.first_error_as_result();
  }
  if (!verify_chunk(file_, scan_, *index, sink)) return sink.first_error_as_result();
  auto decoded = decode_chunk(file_, scan_, *index, sink);
  if (!decoded) return sink.first_error_as_result();
  return std::move(*decoded);
} catch (const std::bad_alloc&) {
  return no_memory();
}

}  // namespace mesocell
