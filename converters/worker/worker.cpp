#include "converters/worker/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

#include "converters/image/module_loader.h"
#include "converters/worker/child_process.h"
#include "converters/worker/wire.h"

namespace mesocell {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 16;

/// Sends the request and takes the reply, both at once, as either side may have to wait for the other.
Status talk(Descriptor& to, Descriptor& from, std::span<const std::byte> request, const WorkerLimits& limits,
            const Progress* progress, std::vector<std::byte>& reply) {
  fcntl(to.get(), F_SETFL, O_NONBLOCK);
  std::vector<std::byte> chunk(kChunkBytes);
  for (;;) {
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "interrupted"};
    pollfd polled[2] = {{from.get(), POLLIN, 0}, {to.get(), POLLOUT, 0}};
    if (poll(polled, to.get() >= 0 ? 2 : 1, 50) < 0) {
      if (errno == EINTR) continue;
      return Error{ErrorCode::kOutput, "the program that reads it cannot be talked to"};
    }
    if (to.get() >= 0 && polled[1].revents != 0) {
      const ssize_t count = write(to.get(), request.data(), std::min(request.size(), kChunkBytes));
      if (count >= 0) request = request.subspan(std::size_t(count));
      // One that has gone tells more by how it ended.
      if ((count < 0 && errno != EINTR && errno != EAGAIN) || request.empty()) to.close();
    }
    if (polled[0].revents == 0) continue;
    const ssize_t count = read(from.get(), chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return {};
    if (reply.size() + std::size_t(count) > limits.max_reply_bytes)
      return Error{ErrorCode::kLimit, "what it holds takes more than " +
                                          std::to_string(limits.max_reply_bytes >> 20) +
                                          " MiB; use a smaller one"};
    reply.insert(reply.end(), chunk.begin(), chunk.begin() + count);
  }
}

Error ended(int status, const std::string& subject, const WorkerLimits& limits) {
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return {ErrorCode::kLimit, "reading " + subject + " took more than the " +
                                   std::to_string(std::uint64_t(limits.max_seconds)) +
                                   " s or the memory that are allowed; use a smaller one"};
  return {ErrorCode::kInvalidInput,
          "the library that reads " + subject + " crashed on it, so it is damaged; fetch or export it again"};
}

}  // namespace

Result<std::vector<std::byte>> run_worker(const std::string& name, std::span<const std::byte> request,
                                          const std::string& subject, const WorkerLimits& limits,
                                          const Progress* progress) {
  const Result<std::string> program = find_module_file(name);
  if (!program) return program.error();
  ByteWriter head;
  write_wire_limits({limits.max_memory_bytes, std::uint64_t(limits.max_seconds) + 1}, head);
  std::vector<std::byte> whole = head.release();
  whole.insert(whole.end(), request.begin(), request.end());

  ChildProcess child;
  Descriptor to, from;
  if (Status status = child.start(*program, {}, to, from); !status) return status.error();
  std::vector<std::byte> reply;
  if (Status status = talk(to, from, whole, limits, progress, reply); !status) return status.error();
  const int status = child.wait();

  ByteReader reader(reply);
  const std::uint32_t magic = reader.u32(), code = reader.u32();
  const std::uint64_t bytes = reader.u64();
  if (status != 0 || reader.overrun() || magic != kWireMagic || bytes != reader.remaining())
    return ended(status, subject, limits);
  const std::size_t begin = reader.position();
  if (code == kWireDone) {
    reply.erase(reply.begin(), reply.begin() + std::ptrdiff_t(begin));
    return reply;
  }
  if (code > std::uint32_t(ErrorCode::kCancelled)) return ended(status, subject, limits);
  const auto text = reader.take(bytes);
  return Error{ErrorCode(code), std::string(reinterpret_cast<const char*>(text.data()), text.size())};
}

}  // namespace mesocell
