#pragma once

#include <atomic>

namespace mesocell {

/// Lets SIGINT and SIGTERM ask the command to stop. A second one ends the process at once, with the temporary
/// files removed. SIGPIPE is ignored: writing to a closed pipe is then an ordinary error.
void install_signal_handlers();

/// Set by the first signal; for Progress::cancel.
[[nodiscard]] const std::atomic<bool>& cancel_flag();

}  // namespace mesocell
