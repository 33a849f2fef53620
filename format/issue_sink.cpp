#include "format/issue_sink.h"

#include <cassert>
#include <utility>

namespace mesocell {

void IssueSink::add(IssueId id, std::optional<std::uint64_t> offset, std::uint32_t chunk,
                    std::string detail) {
  const IssueInfo& info = issue_info(id);
  const bool is_error = info.severity == Severity::kError;
  if (is_error) ++errors_;
  if (info.severity == Severity::kWarning) ++warnings_;
  const bool is_first = is_error && !first_id_;
  if (max_issues_ == 0 && !is_first) return;

  const bool keep = max_issues_ > 0 && issues_.size() < max_issues_ &&
                    of_a_kind_[static_cast<std::size_t>(id)]++ < kMaxOfAKind;
  if (max_issues_ > 0 && !keep) capped_ = true;
  if (max_issues_ > 0 && issues_.size() >= max_issues_ && errors_ > 0) stopped_ = true;
  if (!keep && !is_first) return;

  std::string text(info.text);
  if (!detail.empty()) text.append(": ").append(detail);
  Issue issue{info.id, info.severity, offset, chunk, std::move(text)};
  if (is_first) {
    first_id_ = id;
    first_ = issue;
    if (max_issues_ == 0) stopped_ = true;
  }
  if (keep) issues_.push_back(std::move(issue));
}

Error IssueSink::first_error_as_result() const {
  assert(first_id_);
  const IssueInfo& info = issue_info(*first_id_);
  std::string message = first_.text;
  if (const auto remedy = remedy_text(info.remedy); !remedy.empty()) message.append("; ").append(remedy);
  const ErrorCode code = *first_id_ == IssueId::kLimitExceeded ? ErrorCode::kLimit : ErrorCode::kInvalidInput;
  return Error{code, std::move(message), info.id, first_.offset, first_.chunk};
}

}  // namespace mesocell
