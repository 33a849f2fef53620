#include "converters/worker/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

extern char** environ;

namespace mesocell {
namespace {

Error failure(int reason) {
  return {ErrorCode::kOutput, std::string("a program of its own could not be started for it (") +
                                  std::strerror(reason) + "); close some programs"};
}

}  // namespace

void Descriptor::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) kill(pid_, SIGKILL);
  (void)wait();
}

Status ChildProcess::start(const std::string& program, std::span<const std::string> arguments, Descriptor& to,
                           Descriptor& from, bool silent) {
  int in[2], out[2];
  if (pipe2(in, O_CLOEXEC) != 0) return failure(errno);
  Descriptor child_in(in[0]);
  to = Descriptor(in[1]);
  if (pipe2(out, O_CLOEXEC) != 0) return failure(errno);
  Descriptor child_out(out[1]);
  from = Descriptor(out[0]);
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, child_in.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, child_out.get(), STDOUT_FILENO);
  if (silent) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const int reason = posix_spawn(&pid_, program.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (reason == 0) return {};
  pid_ = -1;
  return failure(reason);
}

void ChildProcess::ask_to_end() const {
  if (pid_ > 0) kill(pid_, SIGTERM);
}

int ChildProcess::wait() {
  int status = 0;
  if (pid_ > 0)
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
  pid_ = -1;
  return status;
}

}  // namespace mesocell
