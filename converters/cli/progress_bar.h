#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "sdk/core/progress.h"

namespace mesocell {

/// A line on the terminal with the stage, a bar and the time left; only for work that takes over a second,
/// and only if stderr is a terminal. Wiped off when it is destroyed or finished.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { finish(); }

  /// To hand to long calls; it carries the cancel flag of interrupt.h too. Refers to this bar.
  [[nodiscard]] const Progress& progress() const { return progress_; }
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  void report(std::string_view stage, double fraction);

  Progress progress_;
  bool on_terminal_ = false;
  bool drawn_ = false;
  Clock::time_point start_, stage_start_, last_drawn_;
  std::string stage_;
};

}  // namespace mesocell
