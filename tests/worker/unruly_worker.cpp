#include <unistd.h>

#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>

#include "converters/worker/serve.h"

using namespace mesocell;

namespace {

Result<std::vector<std::byte>> obey(std::span<const std::byte> request) {
  const std::string text(reinterpret_cast<const char*>(request.data()), request.size());
  if (text == "crash") std::abort();
  if (text == "leave") _exit(0);
  if (text == "hang")
    for (;;)
      if (getppid() == -1) break;  // never, which nobody can tell beforehand
  if (text == "throw") throw std::runtime_error("a wheel came off");
  if (text == "memory") throw std::bad_alloc();
  if (text == "refuse") return Error{ErrorCode::kUsage, "not like this"};
  if (text == "print") {
    if (write(STDOUT_FILENO, "noise", 5) != 5) return Error{ErrorCode::kOutput, "no output"};
    return std::vector<std::byte>{std::byte{7}};
  }
  return std::vector<std::byte>(request.begin(), request.end());
}

}  // namespace

int main() { return serve_request(obey); }
