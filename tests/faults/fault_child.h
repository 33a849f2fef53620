#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

/// Work for processes of its own, with the program fault_child.cpp: what is killed, mounts a file system or
/// takes a limit must not be the test, and a fork beside running threads finds locks held for ever.
namespace mesocell::test {

/// How the program ended.
struct ChildEnd {
  int exit = -1;    ///< its exit code, −1 if a signal ended it
  int signal = 0;   ///< that signal
  std::string err;  ///< what it wrote on stderr
};

inline constexpr int kChildRefused = 76;       ///< an error of the kind that was asked for; see its stderr
inline constexpr int kChildNotPermitted = 77;  ///< the system does not let it mount

/// Starts the program; its stderr goes to the file.
[[nodiscard]] pid_t start_child(const std::vector<std::string>& arguments, const std::string& err_path);
[[nodiscard]] ChildEnd wait_for(pid_t child, const std::string& err_path);
[[nodiscard]] ChildEnd run_child(const std::vector<std::string>& arguments);

/// The bytes that the program saves for a seed: 1 to 200 kB that tell the seed.
[[nodiscard]] std::vector<std::byte> saved_bytes(unsigned seed);

}  // namespace mesocell::test
