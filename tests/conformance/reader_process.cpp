#include "tests/conformance/reader_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace mesocell::conformance {
namespace {

constexpr std::size_t kLongestLine = 4096;
/// After so long without an answer it is time to see whether the reader is still there.
constexpr std::chrono::milliseconds kGlance(100);

std::runtime_error system_failure(const char* what) {
  return std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

}  // namespace

void ReaderProcess::start() {
  std::array<int, 2> in{}, out{};
  if (::pipe2(in.data(), O_CLOEXEC) != 0) throw system_failure("no pipe");
  if (::pipe2(out.data(), O_CLOEXEC) != 0) {
    ::close(in[0]);
    ::close(in[1]);
    throw system_failure("no pipe");
  }
  process_ = ::fork();
  if (process_ == 0) {
    // A group of its own, so that all that the shell starts can be ended; and signals as a program expects
    // them.
    ::setpgid(0, 0);
    ::signal(SIGPIPE, SIG_DFL);
    ::dup2(in[0], STDIN_FILENO);
    ::dup2(out[1], STDOUT_FILENO);
    ::execl("/bin/sh", "sh", "-c", command_.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ::close(in[0]);
  ::close(out[1]);
  to_ = in[1];
  from_ = out[0];
  if (process_ < 0) {
    stop();
    throw system_failure("no process");
  }
  ::setpgid(process_, process_);  // whoever comes first
  ::fcntl(to_, F_SETFL, O_NONBLOCK);
  ::fcntl(from_, F_SETFL, O_NONBLOCK);
}

void ReaderProcess::stop() {
  if (to_ >= 0) ::close(std::exchange(to_, -1));
  if (from_ >= 0) ::close(std::exchange(from_, -1));
  if (process_ <= 0) return;
  ::kill(-process_, SIGKILL);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
}

ReaderProcess::Reply ReaderProcess::fail(const std::string& what) {
  stop();
  return {false, what};
}

bool ReaderProcess::has_ended() {
  if (process_ <= 0 || ::waitpid(process_, &status_, WNOHANG) != process_) return false;
  ::kill(-process_, SIGKILL);  // what it left behind
  process_ = -1;
  return true;
}

std::string ReaderProcess::end_of_process() {
  // A moment is enough for its status; one that lives on has closed its output alone.
  for (int i = 0; i < 100 && process_ > 0 && !has_ended(); ++i) ::poll(nullptr, 0, 10);
  if (process_ > 0) return "it closed its output";
  if (WIFSIGNALED(status_)) return "it was ended by signal " + std::to_string(WTERMSIG(status_));
  return "it ended with status " + std::to_string(WEXITSTATUS(status_));
}

bool ReaderProcess::wait(int descriptor, short events, Clock::time_point until) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    if (left <= 0) return false;
    pollfd ready = {descriptor, events, 0};
    const int count = ::poll(&ready, 1, int(left));
    if (count > 0) return true;
    if (count < 0 && errno != EINTR) return false;
  }
}

ReaderProcess::Reply ReaderProcess::ask(const std::string& line, std::chrono::milliseconds time) {
  const auto until = Clock::now() + time;
  if (process_ < 0) {
    stop();  // the pipes of one that has ended after its last answer
    start();
  }
  std::array<char, 512> buffer{};
  if (::read(from_, buffer.data(), buffer.size()) > 0) return fail("it wrote before it was asked");

  const std::string question = line + "\n";
  for (std::size_t written = 0; written < question.size();) {
    const ssize_t count = ::write(to_, question.data() + written, question.size() - written);
    if (count > 0) {
      written += std::size_t(count);
    } else if (count < 0 && errno == EAGAIN) {
      if (!wait(to_, POLLOUT, until)) return fail("it did not read in time");
    } else if (count == 0 || errno != EINTR) {
      return fail(end_of_process());
    }
  }
  std::string answer;
  for (;;) {
    if (!wait(from_, POLLIN, std::min(until, Clock::now() + kGlance))) {
      if (Clock::now() >= until) return fail("it did not answer in time");
      // What it started may hold its output open; what it wrote itself is there by now.
      if (has_ended() && !wait(from_, POLLIN, Clock::now() + kGlance)) return fail(end_of_process());
      continue;
    }
    const ssize_t count = ::read(from_, buffer.data(), buffer.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) return fail(end_of_process() + (answer.empty() ? "" : " in the middle of a line"));
    answer.append(buffer.data(), std::size_t(count));
    const std::size_t end = answer.find('\n');
    if (end == std::string::npos) {
      if (answer.size() > kLongestLine) return fail("its line has no end");
      continue;
    }
    if (end + 1 < answer.size()) return fail("it wrote more than one line");
    answer.pop_back();
    return {true, answer};
  }
}

}  // namespace mesocell::conformance
