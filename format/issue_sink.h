#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/issues.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// Where the checks of a file report. A reader wants the first error and nothing after it; the validator
/// wants all. Checks ask stopped() where going on is work in vain.
class IssueSink {
 public:
  /// Keeps the first error, then is stopped; drops what is no error.
  [[nodiscard]] static IssueSink first_error() { return IssueSink(0); }
  /// Keeps up to `max_issues` (at least 1), of each kind at most kMaxOfAKind.
  [[nodiscard]] static IssueSink all(std::size_t max_issues) {
    return IssueSink(max_issues > 0 ? max_issues : 1);
  }

  static constexpr std::uint32_t kMaxOfAKind = 16;

  /// `detail` says what was found; it is added to the catalogue's text.
  void add(IssueId id, std::optional<std::uint64_t> offset, std::uint32_t chunk, std::string detail = {});

  /// Whether an issue of this kind would be kept; if not, add() counts it, and making a detail is work in
  /// vain.
  [[nodiscard]] bool wants(IssueId id) const {
    return !stopped_ && of_a_kind_[static_cast<std::size_t>(id)] < kMaxOfAKind;
  }
  /// No further issue will be kept.
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Number of errors so far, also of those not kept. A check compares it before and after.
  [[nodiscard]] std::uint64_t errors() const { return errors_; }
  /// Number of warnings so far, also of those not kept.
  [[nodiscard]] std::uint64_t warnings() const { return warnings_; }
  /// Issues were left out.
  [[nodiscard]] bool capped() const { return capped_; }
  [[nodiscard]] const std::vector<Issue>& issues() const { return issues_; }
  [[nodiscard]] std::vector<Issue> release() { return std::move(issues_); }

  /// The first error as a reader returns it: with the remedy, as kLimit or kInvalidInput. errors() > 0
  /// (assert).
  [[nodiscard]] Error first_error_as_result() const;

 private:
  explicit IssueSink(std::size_t max_issues) : max_issues_(max_issues) {}

  std::size_t max_issues_;  ///< 0: stop at the first error
  std::vector<Issue> issues_;
  std::array<std::uint32_t, static_cast<std::size_t>(IssueId::kCount)> of_a_kind_{};
  std::uint64_t errors_ = 0;
  std::uint64_t warnings_ = 0;
  std::optional<IssueId> first_id_;
  Issue first_;
  bool stopped_ = false;
  bool capped_ = false;
};

}  // namespace mesocell
