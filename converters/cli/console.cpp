#include "converters/cli/console.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

namespace mesocell {
namespace {

void print_message(std::string_view subject, std::string_view text) {
  std::string line = "mesocell: ";
  if (!subject.empty()) line += printable(subject) + ": ";
  line += printable(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

/// False, with errno, if not all of it could be written.
bool print_result(std::string_view text) {
  errno = 0;
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) {
      out += c;
      continue;
    }
    char code[8];
    std::snprintf(code, sizeof code, "\\x%02x", unsigned{static_cast<unsigned char>(c)});
    out += code;
  }
  return out;
}

int Console::fail(const Error& error, const std::string& subject) const {
  return fail_with({error, subject}, nlohmann::ordered_json::object());
}

int Console::fail_with(const Failure& failure, const nlohmann::ordered_json& more) const {
  const Error& error = failure.error;
  // Whoever stopped it knows that; what they want to know is the state of the output.
  if (error.code == ErrorCode::kCancelled)
    return report(ErrorCode::kCancelled, "interrupted; nothing was written", {}, {}, more);
  return report(error.code, error.message, error.id, failure.subject, more);
}

int Console::report(ErrorCode kind, std::string_view message, std::string_view id,
                    const std::string& subject, const nlohmann::ordered_json& more) const {
  const ExitCode code = exit_code(kind);
  print_message(subject, message);
  if (json_) {
    nlohmann::ordered_json object;
    object["error"]["code"] = error_name(kind);
    object["error"]["exit"] = int{code};
    object["error"]["id"] = id;
    object["error"]["message"] = message;
    object["error"]["file"] = subject;
    object.update(more);
    (void)print_result(object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  return code;
}

void Console::warn(const std::string& subject, std::string_view text) const {
  if (!quiet_) print_message(subject, "warning: " + std::string(text));
}

int Console::finish(std::string_view text, int code) const {
  if (print_result(text) || errno == EPIPE) return code;
  print_message("standard output",
                std::string("it cannot be written (") + std::strerror(errno) + "); check where it is sent");
  return kExitOutput;
}

}  // namespace mesocell
