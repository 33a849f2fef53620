#pragma once

#include <atomic>

namespace mesocell {

/// Lets SIGINT, SIGTERM and SIGHUP (unless it is ignored, as nohup does) ask the command to stop. A second
/// one ends the process at once, with the temporary files removed. SIGPIPE and SIGXFSZ are ignored: writing
/// to a closed pipe or beyond the largest file allowed is then an ordinary error.
void install_signal_handlers();

/// Ends this process at once, with the temporary files removed, when the process \p parent, which started it,
/// ends: nobody is left to wait for the cancelling of what takes long.
void end_with_parent(long parent);

/// Set by the first signal; for Progress::cancel.
[[nodiscard]] const std::atomic<bool>& cancel_flag();

}  // namespace mesocell
