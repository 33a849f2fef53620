#include "converters/cli/interrupt.h"

#include <sys/prctl.h>
#include <unistd.h>
#include <csignal>

#include "converters/cli/exit_codes.h"
#include "format/file.h"

namespace mesocell {
namespace {

std::atomic<bool> g_cancelled = false;
static_assert(std::atomic<bool>::is_always_lock_free, "it is set in a signal handler");

extern "C" void end_at_once(int) {
  remove_temporary_files();
  _exit(kExitInterrupted);
}

extern "C" void on_signal(int signal) {
  if (g_cancelled.exchange(true)) end_at_once(signal);
}

}  // namespace

void end_with_parent(long parent) {
  std::signal(SIGUSR1, end_at_once);
  prctl(PR_SET_PDEATHSIG, SIGUSR1);
  // It may have ended before that.
  if (getppid() != parent) std::raise(SIGUSR1);
}

void install_signal_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // The terminal is closed; nohup and the like have it ignored, and mean it.
  struct sigaction hangup = {};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  // write() then says that the file is too large, and the temporary file goes.
  std::signal(SIGXFSZ, SIG_IGN);
}

const std::atomic<bool>& cancel_flag() { return g_cancelled; }

}  // namespace mesocell
