#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "format/api.h"

namespace mesocell MESOCELL_API {

/// How a long call reports and is stopped. Thread safety: `cancel` may be set from any thread or from a
/// signal handler; `report` is called from one thread at a time, with a fraction that never falls.
struct Progress {
  std::function<void(std::string_view stage, double fraction)> report;
  const std::atomic<bool>* cancel = nullptr;

  [[nodiscard]] bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
};

}  // namespace mesocell
