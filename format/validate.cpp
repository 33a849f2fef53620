#include "format/validate.h"

#include <new>

#include "format/block_table.h"
#include "format/container_scan.h"
#include "format/issue_sink.h"
#include "format/representation.h"

namespace mesocell {
namespace {

void validate_asset(std::span<const std::byte> file, ContainerScan& scan, std::size_t asset,
                    const ReadLimits& limits, IssueSink& sink) {
  const AssetInfo& info = scan.assets[asset];
  if (scan.assets.size() > 1 && info.name.empty())
    sink.add(IssueId::kAssetNameMissing, kHeaderBytes + asset * kAssetBytes + 16, 0);
  const bool known = scan_asset(scan, asset, sink);
  for (std::size_t i = 0; i < info.chunk_count && !sink.stopped(); ++i) {
    // What a damaged chunk holds says nothing of what was written.
    const std::size_t chunk = info.first_chunk + i;
    if (scan.usable[chunk]) scan.usable[chunk] = verify_chunk(file, scan, chunk, sink);
  }
  MemoryBudget budget(limits);
  if (!sink.stopped() && known && charge_asset(scan, asset, budget, sink) && !sink.stopped())
    info.rules->check(file, scan, asset, limits, budget, sink);
}

void validate_sections(std::span<const std::byte> file, const ReadLimits& limits, IssueSink& sink) {
  auto scan = scan_container(file, file.size(), limits, sink);
  if (!scan) return;
  for (std::size_t i = 0; i < scan->assets.size() && !sink.stopped(); ++i)
    validate_asset(file, *scan, i, limits, sink);
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
    report.errors = sink.errors();
    report.warnings = sink.warnings();
    report.capped = sink.capped();
    report.issues = sink.release();
  } catch (const std::bad_alloc&) {
    report.valid = false;
    report.capped = true;
  }
  return report;
}

}  // namespace mesocell
