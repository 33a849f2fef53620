#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "tests/faults/fault_child.h"
#include "tests/support/folder.h"

namespace mesocell::test {

pid_t start_child(const std::vector<std::string>& arguments, const std::string& err_path) {
  std::string program = MESOCELL_FAULT_CHILD;
  std::vector<char*> words = {program.data()};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  pid_t child = -1;
  const int error = posix_spawn(&child, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) std::abort();
  return child;
}

ChildEnd wait_for(pid_t child, const std::string& err_path) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  ChildEnd end;
  if (WIFEXITED(status)) end.exit = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  std::ifstream err(err_path);
  end.err.assign(std::istreambuf_iterator<char>(err), {});
  return end;
}

ChildEnd run_child(const std::vector<std::string>& arguments) {
  const Folder folder(in_memory());
  return wait_for(start_child(arguments, folder / "err"), folder / "err");
}

}  // namespace mesocell::test
