#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <utility>

#include "format/result.h"

namespace mesocell {

/// An open file of the system, closed at the latest when this ends.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { close(); }
  void close();
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_ = -1;
};

/// A program that is running, killed and waited for at the latest when this ends. It is started without
/// copying this process, so also beside other threads.
class ChildProcess {
 public:
  ChildProcess() = default;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  /// Its standard input and output become the other ends of `to` and `from`; `silent`: its standard error is
  /// dropped. Errors: kOutput (no such program, too many processes).
  [[nodiscard]] Status start(const std::string& program, std::span<const std::string> arguments,
                             Descriptor& to, Descriptor& from, bool silent = false);
  /// Asks it to end, by SIGTERM, so that it can leave nothing behind.
  void ask_to_end() const;
  /// The status that waitpid() gives, once.
  [[nodiscard]] int wait();

 private:
  pid_t pid_ = -1;
};

}  // namespace mesocell
