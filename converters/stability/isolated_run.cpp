#include "converters/stability/isolated_run.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>

namespace mesocell {
namespace {

using Clock = std::chrono::steady_clock;

/// Wall clock seconds for each second of processor time that is allowed: for busy machines, and methods that
/// hang.
constexpr double kPatience = 20;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What the child tells; written at once, it is below the size that a pipe takes whole.
struct Report {
  std::uint8_t failed;
  double seconds, cpu_seconds;
  std::uint64_t memory_bytes;
  char message[512];
};
static_assert(sizeof(Report) <= 4096);

/// Resident bytes of this process.
std::uint64_t resident_bytes() {
  unsigned long long pages = 0, resident = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%llu %llu", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return resident * std::uint64_t(sysconf(_SC_PAGESIZE));
}

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Of a child that still runs or was not waited for.
double cpu_seconds(pid_t child) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

[[noreturn]] void run_child(const Voxelizer& method, const TriangleMesh& mesh, BitGrid& out, unsigned threads,
                            int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // The parent looks to interruptions; an interrupted terminal signals both.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  Report report{};
  // Not before the fork: libraries may start threads, and a fork beside a running thread finds locks held for
  // ever.
  const Status prepared = method.prepare ? method.prepare() : Status();
  rusage first{};
  getrusage(RUSAGE_SELF, &first);
  const double cpu_before = cpu_seconds(first);
  const std::uint64_t before = resident_bytes();
  const Clock::time_point start = Clock::now();
  std::string message;
  try {
    if (const Status status = prepared.ok() ? method.run(mesh, out, threads) : prepared; !status) {
      report.failed = 1;
      message = status.error().message;
    }
  } catch (const std::exception& exception) {
    report.failed = 1;
    message = exception.what();
  }
  report.seconds = seconds_since(start);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report.cpu_seconds = cpu_seconds(usage) - cpu_before;
  report.memory_bytes = std::max(std::uint64_t(usage.ru_maxrss) * 1024, before) - before;
  std::memcpy(report.message, message.data(), std::min(message.size(), sizeof report.message - 1));
  const ssize_t written = write(pipe, &report, sizeof report);
  _exit(written == sizeof report ? 0 : 1);
}

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status))
    return std::string("its process was ended by signal ") + std::to_string(WTERMSIG(status)) + " (" +
           strsignal(WTERMSIG(status)) + ")";
  return "its process ended with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

Result<IsolatedRun> run_isolated(const Voxelizer& method, const TriangleMesh& mesh, BitGrid& out,
                                 unsigned threads, double max_seconds, const Progress* progress) {
  out.clear();
  int ends[2];
  if (pipe(ends) != 0)
    return Error{ErrorCode::kLimit, "no pipe can be made; close other programs and try again"};
  const Clock::time_point start = Clock::now();
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(method, mesh, out, threads, ends[1]);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return Error{ErrorCode::kLimit, "no process can be made; close other programs and try again"};
  }

  IsolatedRun run;
  bool cancelled = false;
  pollfd waiting{ends[0], POLLIN, 0};
  // Ready with a report or with the end of the child.
  while (poll(&waiting, 1, 20) <= 0) {
    cancelled = progress && progress->cancelled();
    run.seconds = seconds_since(start);
    if (!cancelled && run.seconds <= kPatience * max_seconds && cpu_seconds(child) <= max_seconds) continue;
    run.outcome = RunOutcome::kTooLong;
    kill(child, SIGKILL);
    break;
  }
  Report report{};
  const bool told =
      run.outcome != RunOutcome::kTooLong && read(ends[0], &report, sizeof report) == ssize_t{sizeof report};
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (cancelled) return Error{ErrorCode::kCancelled, "cancelled"};
  if (run.outcome == RunOutcome::kTooLong) return run;
  run.seconds = seconds_since(start);
  if (!told) {
    run.message = how_it_ended(status);
    return run;
  }
  run.seconds = report.seconds;
  run.cpu_seconds = report.failed ? 0 : report.cpu_seconds;
  run.memory_bytes = report.failed ? 0 : report.memory_bytes;
  run.outcome = report.failed ? RunOutcome::kFailed : RunOutcome::kDone;
  report.message[sizeof report.message - 1] = 0;
  run.message = report.message;
  return run;
}

}  // namespace mesocell
