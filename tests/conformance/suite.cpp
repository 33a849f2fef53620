#include "tests/conformance/suite.h"

#include <algorithm>
#include <stdexcept>

#include "format/hash.h"
#include "format/issues.h"
#include "format/validate.h"
#include "tests/conformance/digest.h"

namespace mesocell::test {

bool is_file(const Case& c) {
  const ReadLimits usual;
  return c.bytes.size() <= kMostFileBytes && c.limits.max_file_bytes == usual.max_file_bytes &&
         c.limits.max_decoded_bytes == usual.max_decoded_bytes && c.limits.max_tiles == usual.max_tiles;
}

std::string path_of(const Case& c) { return std::string(verdict_of(c)) + "/" + c.name + ".meso"; }

std::vector<std::string> report_of(std::span<const std::byte> file, const ReadLimits& limits) {
  std::vector<std::string> ids;
  for (const Issue& issue : validate(file, limits).issues)
    if (std::find(ids.begin(), ids.end(), issue.id) == ids.end()) ids.emplace_back(issue.id);
  return ids;
}

conformance::Manifest manifest_of(const std::vector<Case>& cases, std::string_view version) {
  conformance::Manifest manifest;
  manifest.version = version;
  for (const IssueInfo& info : issue_catalogue())
    manifest.rules.push_back({std::string(info.id), std::string(info.clause),
                              std::string(severity_name(info.severity)), std::string(info.text)});
  for (const Case& c : cases) {
    if (!is_file(c) || c.version != version) continue;
    conformance::Entry entry;
    entry.path = path_of(c);
    entry.verdict = verdict_of(c);
    entry.clause = c.clause;
    entry.issue = c.issue;
    entry.report = report_of(c.bytes);
    entry.xxh64 = conformance::hex16(hash64(c.bytes));
    entry.bytes = c.bytes.size();
    if (entry.verdict == "valid") {
      const auto digest = digest_of_chunks(c.bytes);
      if (!digest) throw std::logic_error(c.name + " is not valid: " + digest.error().message);
      entry.digest = conformance::hex16(*digest);
    }
    manifest.files.push_back(std::move(entry));
  }
  return manifest;
}

}  // namespace mesocell::test
