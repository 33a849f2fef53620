#include "tests/cli/run_command.h"

#include <fcntl.h>
#include <pty.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <thread>

#include "tests/import/mesh_bytes.h"

namespace mesocell::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Opens what the child gets as stdout and stderr; all else is done before the fork.
struct Streams {
  int out = -1, err = -1, terminal = -1;
};

Streams open_streams(const TempFolder& folder, const RunOptions& options) {
  Streams streams;
  const std::string out = options.stdout_path.empty() ? folder.file("out") : options.stdout_path;
  streams.out = open(out.c_str(), O_WRONLY | O_CREAT, 0600);
  streams.err = open(folder.file("err").c_str(), O_WRONLY | O_CREAT, 0600);
  if (options.closed_stdout) {
    int ends[2] = {};
    if (pipe(ends) != 0) std::abort();
    close(ends[0]);
    close(streams.out);
    streams.out = ends[1];
  }
  if (options.terminal) {
    close(streams.err);
    if (openpty(&streams.terminal, &streams.err, nullptr, nullptr, nullptr) != 0) std::abort();
    fcntl(streams.terminal, F_SETFL, O_NONBLOCK);
  }
  if (streams.out < 0 || streams.err < 0) std::abort();
  return streams;
}

/// Takes what has come to the terminal, so that its buffer never fills.
void drain(int terminal, std::string& text) {
  char buffer[4096];
  for (ssize_t n = 0; terminal >= 0 && (n = read(terminal, buffer, sizeof buffer)) > 0;)
    text.append(buffer, std::size_t(n));
}

}  // namespace

std::size_t Run::messages() const { return std::size_t(std::count(err.begin(), err.end(), '\n')); }

Run run_command(const std::vector<std::string>& arguments, const RunOptions& options) {
  return run_program(MESOCELL_COMMAND, arguments, options);
}

Run run_program(const std::string& program, const std::vector<std::string>& arguments,
                const RunOptions& options) {
  const TempFolder folder;
  const Streams streams = open_streams(folder, options);
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  // Of two values of a name the first one counts.
  std::vector<char*> environment;
  for (const std::string& variable : options.environment)
    environment.push_back(const_cast<char*>(variable.c_str()));
  for (char** variable = environ; *variable; ++variable) environment.push_back(*variable);
  environment.push_back(nullptr);
  // Not fork(): a library of pictures in this process has threads, whose locks a child would inherit.
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, streams.out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, streams.err, STDERR_FILENO);
  pid_t child = -1;
  const int error = posix_spawn(&child, program.c_str(), &actions, nullptr, words.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) std::abort();
  close(streams.out);
  close(streams.err);
  Run run;
  const Clock::time_point start = Clock::now();
  bool signalled = false;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    const auto spent = Clock::now() - start;
    const bool seen = !options.signal_when.empty() && run.err.find(options.signal_when) != std::string::npos;
    if (!signalled && (seen || (options.signal_after && spent >= *options.signal_after))) {
      signalled = true;
      kill(child, options.signal);
    }
    if (spent > std::chrono::minutes(2)) kill(child, SIGKILL);
    drain(streams.terminal, run.err);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  drain(streams.terminal, run.err);
  if (streams.terminal >= 0) close(streams.terminal);
  run.exit = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  run.out = read_bytes(folder.file("out"));
  if (!options.terminal) run.err = read_bytes(folder.file("err"));
  return run;
}

}  // namespace mesocell::test
