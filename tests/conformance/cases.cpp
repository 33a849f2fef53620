#include "tests/conformance/cases.h"

#include <algorithm>
#include <stdexcept>

#include "format/issues.h"

namespace mesocell::test {
namespace {

const IssueInfo& info_of(std::string_view id) {
  const auto all = issue_catalogue();
  const auto at = std::find_if(all.begin(), all.end(), [&](const IssueInfo& info) { return info.id == id; });
  if (at == all.end()) throw std::logic_error("no issue " + std::string(id));
  return *at;
}

}  // namespace

void CaseList::valid(std::string_view name, std::string_view clause, Bytes bytes, std::string_view issue,
                     const ReadLimits& limits) {
  const std::string_view id = issue.empty() ? std::string_view() : info_of(issue).id;
  cases_.push_back({std::string(name), clause, id, false, std::move(bytes), limits, version_});
}

void CaseList::add_invalid(std::string_view name, bool sole, Bytes bytes, const ReadLimits& limits) {
  const IssueInfo& info = info_of(name.substr(0, name.find('/')));
  cases_.push_back({std::string(name), info.clause, info.id, sole, std::move(bytes), limits, version_});
}

void CaseList::fault(std::string_view name, Bytes bytes, const ReadLimits& limits) {
  add_invalid(name, true, std::move(bytes), limits);
}

void CaseList::faults(std::string_view name, Bytes bytes, const ReadLimits& limits) {
  add_invalid(name, false, std::move(bytes), limits);
}

void CaseList::limit(std::string_view name, Bytes bytes, const ReadLimits& limits) {
  add_invalid("limit-exceeded/" + std::string(name), true, std::move(bytes), limits);
}

std::string_view verdict_of(const Case& c) {
  if (c.issue.empty() || info_of(c.issue).severity != Severity::kError) return "valid";
  return c.issue == "limit-exceeded" ? "limit" : "invalid";
}

std::vector<Case> conformance_cases() {
  CaseList cases;
  add_header_cases(cases);
  add_asset_cases(cases);
  add_directory_cases(cases);
  add_layout_cases(cases);
  add_block_cases(cases);
  add_zstd_cases(cases);
  add_grid_cases(cases);
  add_tile_cases(cases);
  add_piece_cases(cases);
  add_membership_cases(cases);
  add_text_cases(cases);
  add_color_cases(cases);
  add_normal_cases(cases);
  add_version_cases(cases);
  cases.of_version("1.1");
  add_mesh_cases(cases);
  add_surface_color_cases(cases);
  return cases.release();
}

}  // namespace mesocell::test
