#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>

/// A reader under test: a process that is asked in lines.
namespace mesocell::conformance {

class ReaderProcess {
 public:
  /// `command` is for sh -c. Nothing runs before the first ask(). SIGPIPE must be ignored.
  explicit ReaderProcess(std::string command) : command_(std::move(command)) {}
  ~ReaderProcess() { stop(); }
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  /// What came of a question.
  struct Reply {
    bool answered = false;
    std::string text;  ///< the answer without its line feed, or what went wrong
  };
  /// Writes `line` and waits for one line. If it does not come in time, or not alone, the process is ended,
  /// and the next ask() starts it again. Throws std::runtime_error if no process can be made.
  Reply ask(const std::string& line, std::chrono::milliseconds time);
  /// Ends the process and what it started.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  void start();
  Reply fail(const std::string& what);
  /// Whether the process is no more; if so, what it started is ended.
  bool has_ended();
  /// What became of the process that has ended or closed its output.
  std::string end_of_process();
  /// Waits for a descriptor; false if the time is up.
  static bool wait(int descriptor, short events, Clock::time_point until);

  std::string command_;
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
  int status_ = 0;  ///< of the process that has ended
};

}  // namespace mesocell::conformance
