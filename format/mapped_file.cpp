#include "format/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <limits>
#include <new>
#include <utility>

#include "format/system_call.h"

namespace mesocell {
namespace {

constexpr int kMappings = 1024;

/// A mapping as the signal handler sees it, in fixed storage.
struct Mapping {
  std::atomic<bool> taken{false};
  /// Odd while `begin` and `end` hold a mapping. It changes with every mapping, so that a handler that looks
  /// at a slot that is not its own never mixes two.
  std::atomic<std::uint64_t> version{0};
  std::atomic<std::uintptr_t> begin{0};
  std::atomic<std::uintptr_t> end{0};
  std::atomic<bool> lost{false};
};
std::array<Mapping, kMappings> mappings;
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);
static_assert(std::atomic<bool>::is_always_lock_free);

/// Written before the handler is installed, and constant then.
struct sigaction previous_action = {};
std::uintptr_t page_bytes = 0;

Mapping& slot_at(int index) { return mappings[static_cast<std::size_t>(index)]; }

int claim_slot() {
  for (int i = 0; i < kMappings; ++i)
    if (!slot_at(i).taken.exchange(true)) return i;
  return -1;
}

void publish(Mapping& slot, const void* data, std::size_t size) {
  const auto begin = reinterpret_cast<std::uintptr_t>(data);
  slot.lost.store(false);
  slot.begin.store(begin);
  slot.end.store(begin + (size + page_bytes - 1) / page_bytes * page_bytes);
  slot.version.fetch_add(1);
}

/// What the kernel would have done, had this handler not taken the place of the previous one.
void chain(int signal, siginfo_t* info, void* context) {
  // A handler that was to be called once, to return, and to leave the second fault to the default action.
  const bool once = (static_cast<unsigned>(previous_action.sa_flags) & unsigned{SA_RESETHAND}) != 0;
  // si_code is positive if the kernel raised the signal for this very access.
  const bool sent = info->si_code <= 0;
  const bool siginfo = (previous_action.sa_flags & SA_SIGINFO) != 0;
  if (!siginfo && previous_action.sa_handler == SIG_IGN && sent) return;
  const bool none =
      !siginfo && (previous_action.sa_handler == SIG_IGN || previous_action.sa_handler == SIG_DFL);
  if (none || once) {
    struct sigaction standard = {};
    standard.sa_handler = SIG_DFL;
    sigemptyset(&standard.sa_mask);
    ::sigaction(SIGBUS, &standard, nullptr);
  }
  if (siginfo) {
    previous_action.sa_sigaction(signal, info, context);
  } else if (!none) {
    previous_action.sa_handler(signal);
  } else if (sent) {
    ::raise(SIGBUS);  // is delivered when the handler returns, as the access faults again otherwise
  }
}

extern "C" void on_bus_error(int signal, siginfo_t* info, void* context) {
  if (info->si_code > 0 && MappedFile::handle_fault(info->si_addr)) return;
  chain(signal, info, context);
}

bool install_handler() {
  page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  if (::sigaction(SIGBUS, nullptr, &previous_action) != 0) return false;
  struct sigaction action = {};
  action.sa_sigaction = on_bus_error;
  action.sa_mask = previous_action.sa_mask;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART | (previous_action.sa_flags & SA_NODEFER);
  return ::sigaction(SIGBUS, &action, nullptr) == 0;
}

}  // namespace

Result<MappedFile> MappedFile::open(const std::string& path, std::uint64_t max_bytes) try {
  static const bool installed = install_handler();
  if (!installed) return unreadable("it cannot be mapped: the system lets no handler for lost memory be set");
  MappedFile file;
  // A pipe would wait for its writer.
  file.descriptor_ = retried([&] { return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC); });
  if (file.descriptor_ < 0) return unreadable("it cannot be opened: " + reason(errno));
  struct stat info {};
  if (retried([&] { return ::fstat(file.descriptor_, &info); }) != 0)
    return unreadable("it cannot be read: " + reason(errno));
  if (S_ISDIR(info.st_mode)) return unreadable("it is a folder; give a file");
  if (!S_ISREG(info.st_mode))
    return unreadable("it is a pipe or a device and cannot be mapped; copy it to a file");
  const auto size = static_cast<std::uint64_t>(info.st_size);
  if (size > max_bytes || size > std::numeric_limits<std::size_t>::max() / 2)
    return Error{ErrorCode::kLimit, "it has more than " + std::to_string(max_bytes) + " bytes"};
  file.changed_seconds_ = info.st_mtim.tv_sec;
  file.changed_nanoseconds_ = info.st_mtim.tv_nsec;
  if (size == 0) return file;

  file.slot_ = claim_slot();
  if (file.slot_ < 0)
    return Error{ErrorCode::kLimit, "more than " + std::to_string(kMappings) + " files are mapped at once"};
  void* const data =
      ::mmap(nullptr, static_cast<std::size_t>(size), PROT_READ, MAP_SHARED, file.descriptor_, 0);
  if (data == MAP_FAILED) {
    const int error = errno;
    const std::string message = "it cannot be mapped: " + reason(error);
    return error == ENOMEM ? Error{ErrorCode::kLimit, message} : unreadable(message);
  }
  file.data_ = static_cast<const std::byte*>(data);
  file.size_ = static_cast<std::size_t>(size);
  publish(slot_at(file.slot_), data, file.size_);
  return file;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      changed_seconds_(other.changed_seconds_),
      changed_nanoseconds_(other.changed_nanoseconds_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      slot_(std::exchange(other.slot_, -1)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  if (this == &other) return *this;
  close();
  data_ = std::exchange(other.data_, nullptr);
  size_ = std::exchange(other.size_, 0);
  changed_seconds_ = other.changed_seconds_;
  changed_nanoseconds_ = other.changed_nanoseconds_;
  descriptor_ = std::exchange(other.descriptor_, -1);
  slot_ = std::exchange(other.slot_, -1);
  return *this;
}

MappedFile::~MappedFile() { close(); }

void MappedFile::close() noexcept {
  if (data_) {
    slot_at(slot_).version.fetch_add(1);
    ::munmap(const_cast<std::byte*>(data_), size_);
    data_ = nullptr;
    size_ = 0;
  }
  if (slot_ >= 0) slot_at(std::exchange(slot_, -1)).taken.store(false);
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

Status MappedFile::check() const try {
  if (slot_ >= 0 && slot_at(slot_).lost.load())
    return unreadable("it became shorter, or its disk failed, while it was read; read it again");
  struct stat info {};
  if (retried([&] { return ::fstat(descriptor_, &info); }) != 0)
    return unreadable("it cannot be read: " + reason(errno));
  // What is cut off within the last page reads as zeros without a signal.
  if (static_cast<std::uint64_t>(info.st_size) != size_ || info.st_mtim.tv_sec != changed_seconds_ ||
      info.st_mtim.tv_nsec != changed_nanoseconds_)
    return unreadable("it was changed while it was read; read it again");
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

bool MappedFile::handle_fault(const void* address) noexcept {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  for (Mapping& slot : mappings) {
    const std::uint64_t version = slot.version.load();
    const std::uintptr_t begin = slot.begin.load();
    const std::uintptr_t end = slot.end.load();
    if (version % 2 == 0 || at < begin || at >= end || slot.version.load() != version) continue;
    slot.lost.store(true);
    const int saved = errno;
    const std::uintptr_t page = at / page_bytes * page_bytes;
    const void* const zeros = ::mmap(reinterpret_cast<void*>(page), end - page, PROT_READ,
                                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    errno = saved;
    return zeros != MAP_FAILED;
  }
  return false;
}

}  // namespace mesocell
