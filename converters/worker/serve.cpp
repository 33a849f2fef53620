#include "converters/worker/serve.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <exception>
#include <new>
#include <string>

#include "converters/worker/wire.h"
#include "format/byte_reader.h"
#include "format/byte_writer.h"

#if defined(__SANITIZE_ADDRESS__)
#define MESOCELL_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define MESOCELL_SANITIZED 1
#endif
#endif
#ifndef MESOCELL_SANITIZED
#define MESOCELL_SANITIZED 0
#endif

namespace mesocell {
namespace {

bool read_all(int descriptor, std::vector<std::byte>& bytes) {
  std::byte buffer[65536];
  for (;;) {
    const ssize_t count = read(descriptor, buffer, sizeof buffer);
    if (count == 0) return true;
    if (count < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    bytes.insert(bytes.end(), buffer, buffer + count);
  }
}

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    bytes = bytes.subspan(std::size_t(count));
  }
  return true;
}

/// Limits are the first thing in a request. They are set here, after the program was loaded, so that nobody
/// else's are touched.
void obey(const WireLimits& limits) {
  rlimit core{0, 0};
  setrlimit(RLIMIT_CORE, &core);
  rlimit cpu{limits.cpu_seconds, limits.cpu_seconds};
  setrlimit(RLIMIT_CPU, &cpu);
#if !MESOCELL_SANITIZED  // sanitizers reserve terabytes
  rlimit memory{limits.memory_bytes, limits.memory_bytes};
  setrlimit(RLIMIT_AS, &memory);
#endif
}

Result<std::vector<std::byte>> guarded(
    const std::function<Result<std::vector<std::byte>>(std::span<const std::byte>)>& handler,
    std::span<const std::byte> request) {
  try {
    return handler(request);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "it takes more memory than is allowed; use a smaller one"};
  } catch (const std::exception& exception) {
    return Error{ErrorCode::kInvalidInput, std::string("the library that reads it gave up (") +
                                               exception.what() + "); repair the file"};
  }
}

}  // namespace

int serve_request(
    const std::function<Result<std::vector<std::byte>>(std::span<const std::byte> request)>& handler) {
  // Whoever started this one and died waits for nothing any more.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // the parent hears of it too, and ends this one
  std::vector<std::byte> request;
  if (!read_all(STDIN_FILENO, request)) return 1;
  ByteReader reader(request);
  const WireLimits limits = read_wire_limits(reader);
  if (reader.overrun()) return 1;
  obey(limits);
  // A library that prints would write into the reply.
  const int reply = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (reply < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) return 1;
#if !MESOCELL_SANITIZED
  dup2(nowhere, STDERR_FILENO);
#endif

  const Result<std::vector<std::byte>> result =
      guarded(handler, std::span(request).subspan(reader.position()));
  ByteWriter head;
  head.u32(kWireMagic);
  if (result) {
    head.u32(kWireDone);
    head.u64(result->size());
    if (!write_all(reply, head.bytes()) || !write_all(reply, *result)) return 1;
  } else {
    head.u32(std::uint32_t(result.error().code));
    head.u64(result.error().message.size());
    head.append(result.error().message);
    if (!write_all(reply, head.bytes())) return 1;
  }
  return 0;
}

}  // namespace mesocell
