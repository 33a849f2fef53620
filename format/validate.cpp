#include "format/validate.h"

#include <new>

#include "format/container_scan.h"
#include "format/issue_sink.h"
#include "format/representation.h"

namespace mesocell {
namespace {

void validate_sections(std::span<const std::byte> file, const ReadLimits& limits, IssueSink& sink) {
  MemoryBudget budget(limits);
  auto scan = scan_container(file, limits, budget, sink);
  if (!scan) return;
  for (std::size_t i = 0; i < scan->chunks.size() && !sink.stopped(); ++i) {
    // What a damaged chunk holds says nothing of what was written.
    if (scan->usable[i]) scan->usable[i] = verify_chunk(file, *scan, i, sink);
  }
  if (scan->rules && !scan->over_limit && !sink.stopped())
    scan->rules->check(file, *scan, limits, budget, sink);
}

}  // namespace

ValidationReport validate(std::span<const std::byte> file, const ReadLimits& limits, std::size_t max_issues) {
  ValidationReport report;
  IssueSink sink = IssueSink::all(max_issues);
  try {
    try {
      validate_sections(file, limits, sink);
    } catch (const std::bad_alloc&) {
      sink.add(IssueId::kLimitExceeded, std::nullopt, 0, "there is not enough memory");
    }
    report.valid = sink.errors() == 0;
    report.capped = sink.capped();
    report.issues = sink.release();
  } catch (const std::bad_alloc&) {
    report.valid = false;
    report.capped = true;
  }
  return report;
}

}  // namespace mesocell
