#include <map>
#include <set>
#include <string>
#include <vector>

#include "format/hash.h"
#include "format/issues.h"
#include "tests/conformance/cases.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Made once: it takes a second.
const std::vector<Case>& all_cases() {
  static const std::vector<Case> cases = conformance_cases();
  return cases;
}

bool is_error(std::string_view id) {
  for (const IssueInfo& info : issue_catalogue())
    if (info.id == id) return info.severity == Severity::kError;
  return false;
}

}  // namespace

TEST_CASE("conformance: every issue has cases, and every error a case of it alone") {
  std::map<std::string_view, int> cases_of, sole_cases_of;
  for (const Case& c : all_cases()) {
    ++cases_of[c.issue];
    if (c.sole) ++sole_cases_of[c.issue];
  }
  for (const IssueInfo& info : issue_catalogue()) {
    CAPTURE(info.id);
    CHECK(cases_of[info.id] > 0);
    CHECK((info.severity != Severity::kError || sole_cases_of[info.id] > 0));
  }
}

TEST_CASE("conformance: cases are many, and differ in name and bytes") {
  std::size_t invalid = 0;
  std::set<std::string> names;
  std::map<std::pair<std::size_t, std::uint64_t>, std::string> files;
  for (const Case& c : all_cases()) {
    invalid += verdict_of(c) == "invalid";
    if (!names.insert(c.name).second) FAIL_CHECK(c.name << " occurs twice");
    // With other limits, the same bytes are another case.
    if (!(c.limits.max_file_bytes == ReadLimits{}.max_file_bytes &&
          c.limits.max_decoded_bytes == ReadLimits{}.max_decoded_bytes &&
          c.limits.max_tiles == ReadLimits{}.max_tiles))
      continue;
    const auto [at, is_new] = files.try_emplace({c.bytes.size(), hash64(c.bytes)}, c.name);
    if (!is_new) FAIL_CHECK(c.name << " has the bytes of " << at->second);
  }
  CHECK(invalid >= 1200);
}

TEST_CASE("conformance: reader, validator and loader say of each case what they should") {
  for (const Case& c : all_cases()) {
    const Verdicts v = verdicts(c.bytes, c.limits);
    const bool valid = verdict_of(c) == "valid";
    std::string wrong;
    if (!v.agree)
      wrong = "they do not agree: " + v.why;
    else if (v.reader != valid)
      wrong = valid ? "refused for " + v.reader_id + ", " + v.loader_text : "taken";
    else if (v.limit != (verdict_of(c) == "limit"))
      wrong = "a limit taken for a fault, or the reverse";
    else if (!c.issue.empty() && !v.has(c.issue))
      wrong = "the issue is not reported";
    std::string ids;
    for (const std::string& id : v.issues) {
      ids += " " + id;
      const bool expected =
          id == c.issue ||
          (!is_error(id) && (c.issue.empty() || is_error(c.issue) || id == "chunk-unknown-skippable"));
      if (wrong.empty() && !expected && (c.sole || valid)) wrong = "there is another issue";
    }
    if (wrong.empty() && c.sole && v.reader_id != c.issue) wrong = "the reader stops at " + v.reader_id;
    if (!wrong.empty()) FAIL_CHECK(c.name << ": " << wrong << "; issues:" << ids);
  }
}
