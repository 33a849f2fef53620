#include "converters/bench/gnuplot.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

extern char** environ;

namespace mesocell {
namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;
constexpr std::chrono::minutes kPatience{2};

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// A file without a name, gone when it is closed.
using NamelessFile = std::unique_ptr<std::FILE, FileCloser>;

Error no_file() {
  return Error{ErrorCode::kOutput,
               std::string("no temporary file can be made: ") + std::strerror(errno) + "; make room in /tmp"};
}

std::vector<std::byte> content(std::FILE* file) {
  std::vector<std::byte> bytes;
  const off_t size = lseek(fileno(file), 0, SEEK_END);
  if (size <= 0 || std::size_t(size) > kMostBytes) return bytes;
  bytes.resize(std::size_t(size));
  std::rewind(file);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file));
  return bytes;
}

/// The last line that says something.
std::string last_line(const std::vector<std::byte>& bytes) {
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string last;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    if (line.find_first_not_of(" \t^") != line.npos) last = line;
    begin = end + 1;
  }
  return last.substr(0, 200);
}

/// Waits for the end of a process. It is killed if that takes too long or is not wanted any more.
Result<int> wait_for(pid_t child, const Progress* progress) {
  const auto start = std::chrono::steady_clock::now();
  for (int status = 0;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    const bool cancelled = progress && progress->cancelled();
    if (cancelled || std::chrono::steady_clock::now() - start > kPatience) {
      kill(child, SIGKILL);
      while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
      if (cancelled) return Error{ErrorCode::kCancelled, "cancelled"};
      return Error{ErrorCode::kLimit, "gnuplot took over two minutes; chart fewer rows"};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace

Result<std::vector<std::byte>> run_gnuplot(const std::string& script, const Progress* progress) {
  const NamelessFile in(std::tmpfile()), out(std::tmpfile()), messages(std::tmpfile());
  if (!in || !out || !messages) return no_file();
  if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() || std::fflush(in.get()) != 0)
    return no_file();
  std::rewind(in.get());
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(messages.get()), STDERR_FILENO);
  // Nobody's settings: the same rows give the same picture.
  char name[] = "gnuplot", defaults[] = "--default-settings", input[] = "-";
  char* const arguments[] = {name, defaults, input, nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, name, &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed == ENOENT)
    return Error{ErrorCode::kOutput,
                 "gnuplot, which draws charts, is not in PATH; install it (package gnuplot-nox)"};
  if (failed)
    return Error{ErrorCode::kOutput, std::string("gnuplot cannot be started: ") + std::strerror(failed)};
  const Result<int> status = wait_for(child, progress);
  if (!status) return status.error();
  std::vector<std::byte> bytes = content(out.get());
  if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0 || bytes.empty())
    return Error{ErrorCode::kOutput, "gnuplot failed (" + last_line(content(messages.get())) +
                                         "); it must have the terminals svg and pngcairo, as package "
                                         "gnuplot-nox has"};
  return bytes;
}

std::string gnuplot_text(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 120)) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += letter || std::strchr(" _.:/+-=,;()%@*<>[]", c) ? c : '?';
  }
  return out + "'";
}

}  // namespace mesocell
