#include "converters/cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "converters/cli/interrupt.h"

namespace mesocell {
namespace {

std::string duration_text(double seconds) {
  const long total = std::lround(std::min(seconds, 359'999.0));
  char text[32];
  if (total < 60)
    std::snprintf(text, sizeof text, "%ld s", total);
  else if (total < 3600)
    std::snprintf(text, sizeof text, "%ld:%02ld min", total / 60, total % 60);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld h", total / 3600, total / 60 % 60);
  return text;
}

}  // namespace

ProgressBar::ProgressBar(bool wanted) : start_(Clock::now()), stage_start_(start_), last_drawn_(start_) {
  on_terminal_ = wanted && isatty(STDERR_FILENO) == 1;
  progress_.cancel = &cancel_flag();
  if (on_terminal_)
    progress_.report = [this](std::string_view stage, double fraction) { report(stage, fraction); };
}

void ProgressBar::report(std::string_view stage, double fraction) {
  const Clock::time_point now = Clock::now();
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = now;
  }
  if (now - start_ < std::chrono::seconds(1) || now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;
  const double done = std::clamp(fraction, 0.0, 1.0);
  const double spent = std::chrono::duration<double>(now - stage_start_).count();
  constexpr int kCells = 30;
  const int filled = int(done * kCells);
  std::string line = "\r\x1b[K" + stage_ + " [" + std::string(std::size_t(filled), '#') +
                     std::string(std::size_t(kCells - filled), '.') + "] " + std::to_string(int(100 * done)) +
                     " %";
  // Before that the estimate jumps about.
  if (done > 0.02 && spent > 0.5) line += ", " + duration_text(spent * (1 - done) / done) + " left";
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::finish() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace mesocell
