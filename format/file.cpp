#define _FILE_OFFSET_BITS 64  // sizes of files on 32-bit machines
#include "format/file.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <string_view>
#include <utility>

#include "format/system_call.h"

namespace mesocell {
namespace {

constexpr int kSlots = 64;
constexpr int kMaxLinks = 40;
/// Longer ones are no file type's, and would make the temporary name too long where the target's is not.
constexpr std::size_t kMaxExtension = 64;
constexpr std::size_t kReadStep = std::size_t{1} << 20;

/// Names that a signal handler must be able to read, so they stand in fixed storage.
struct Slot {
  enum State : int { kFree, kClaimed, kLive };
  std::atomic<int> state{kFree};
  char path[PATH_MAX] = {};
};
std::array<Slot, kSlots> slots;
static_assert(std::atomic<int>::is_always_lock_free);

/// Index of a claimed slot that holds the name, not yet live; -1 if all are taken.
int claim_slot(const std::string& path) {
  for (int i = 0; i < kSlots; ++i) {
    Slot& slot = slots[static_cast<std::size_t>(i)];
    int expected = Slot::kFree;
    if (!slot.state.compare_exchange_strong(expected, Slot::kClaimed)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    return i;
  }
  return -1;
}

void set_slot(int index, Slot::State state) {
  if (index >= 0) slots[static_cast<std::size_t>(index)].state.store(state);
}

Error output_error(std::string message) { return Error{ErrorCode::kOutput, std::move(message)}; }

/// Part of a path up to its last slash, with it; empty if there is none.
std::string folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
}

std::string extension_of(const std::string& path) {
  const std::string name = path.substr(folder_of(path).size());
  const auto dot = name.rfind('.');
  const bool none = dot == std::string::npos || dot == 0 || name.size() - dot > kMaxExtension;
  return none ? std::string() : name.substr(dot);
}

/// Follows symbolic links, also to what is not there yet, so that the link stays and its target is replaced.
Result<std::string> follow_links(std::string path) {
  for (int i = 0; i < kMaxLinks; ++i) {
    struct stat info {};
    if (retried([&] { return ::lstat(path.c_str(), &info); }) != 0) {
      if (errno == ENOENT) return path;
      return output_error("it cannot be written: " + reason(errno));
    }
    if (!S_ISLNK(info.st_mode)) return path;
    std::array<char, PATH_MAX> link{};
    const ssize_t size = retried([&] { return ::readlink(path.c_str(), link.data(), link.size()); });
    if (size < 0) return output_error("the symbolic link cannot be followed: " + reason(errno));
    const std::string to(link.data(), static_cast<std::size_t>(size));
    path = !to.empty() && to[0] == '/' ? to : folder_of(path) + to;
  }
  return output_error("the symbolic link cannot be followed: " + reason(ELOOP));
}

/// Flushes a file or folder that is given by name.
int sync_path(const std::string& path, int flags) {
  const int descriptor = retried([&] { return ::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC); });
  if (descriptor < 0) return errno;
  const int error = retried([&] { return ::fsync(descriptor); }) == 0 ? 0 : errno;
  ::close(descriptor);
  return error;
}

/// Gives `from` the name `to` unless that is taken. Returns 0 or an errno.
int rename_no_replace(const std::string& from, const std::string& to) {
#ifdef RENAME_NOREPLACE
  const auto move = [&] {
    return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  };
  if (retried(move) == 0) return 0;
  // Not all file systems know how.
  if (errno != EINVAL && errno != ENOSYS) return errno;
#endif
  if (retried([&] { return ::link(from.c_str(), to.c_str()); }) != 0) return errno;
  (void)retried([&] { return ::unlink(from.c_str()); });
  return 0;
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::string& path, std::uint64_t max_bytes) try {
  const int descriptor = retried([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC); });
  if (descriptor < 0) return unreadable("it cannot be opened: " + reason(errno));
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } const closer{descriptor};

  struct stat info {};
  if (retried([&] { return ::fstat(descriptor, &info); }) != 0)
    return unreadable("it cannot be read: " + reason(errno));
  if (S_ISDIR(info.st_mode)) return unreadable("it is a folder; give a file");
  const auto over_limit = [&] {
    return Error{ErrorCode::kLimit, "it has more than " + std::to_string(max_bytes) + " bytes"};
  };
  std::vector<std::byte> bytes;
  std::uint64_t expected = 0;
  if (S_ISREG(info.st_mode)) {
    expected = static_cast<std::uint64_t>(info.st_size);
    if (expected > max_bytes) return over_limit();
    // The end is found without more memory.
    if (expected >= bytes.max_size()) throw std::bad_alloc();
    bytes.reserve(static_cast<std::size_t>(expected + 1));
  }
  // Pipes and devices have no size, and a file may grow while it is read.
  for (;;) {
    const std::size_t have = bytes.size();
    const std::size_t room = bytes.capacity() - have;
    bytes.resize(have + (room > 0 ? std::min(room, kReadStep) : kReadStep));
    const ssize_t got = retried([&] { return ::read(descriptor, bytes.data() + have, bytes.size() - have); });
    if (got < 0) return unreadable("it cannot be read: " + reason(errno));
    bytes.resize(have + static_cast<std::size_t>(got));
    if (bytes.size() > max_bytes) return over_limit();
    if (got > 0) continue;
    if (bytes.size() < expected) return unreadable("it became shorter while it was read; read it again");
    return bytes;
  }
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<AtomicFile> AtomicFile::create(const std::string& path, bool no_clobber) try {
  static std::atomic<unsigned> counter{0};
  if (path.empty()) return output_error("the name is empty");
  auto target = follow_links(path);
  if (!target) return target.error();
  AtomicFile file;
  file.target_ = std::move(*target);
  file.no_clobber_ = no_clobber;

  struct stat info {};
  const bool exists = retried([&] { return ::stat(file.target_.c_str(), &info); }) == 0;
  if (!exists && errno != ENOENT) return output_error("it cannot be written: " + reason(errno));
  if (exists && no_clobber) return output_error("it exists already and is to be kept");
  if (exists && S_ISDIR(info.st_mode)) return output_error("it is a folder; give a file");
  if (exists && !S_ISREG(info.st_mode))
    return output_error("it is not a regular file and will not be replaced");
  if (exists && retried([&] { return ::access(file.target_.c_str(), W_OK); }) != 0)
    return output_error("it cannot be replaced: " + reason(errno));

  // A private file must not be open to all where fchmod() fails.
  const mode_t mode = exists ? info.st_mode & 0777 : 0666;
  for (;;) {
    file.temporary_ = folder_of(file.target_) + ".mesocell-" + std::to_string(::getpid()) + "-" +
                      std::to_string(counter.fetch_add(1)) + extension_of(file.target_);
    if (file.temporary_.size() >= PATH_MAX)
      return output_error("it cannot be written: " + reason(ENAMETOOLONG));
    file.slot_ = claim_slot(file.temporary_);
    if (file.slot_ < 0) return output_error("too many files are being written at once");
    file.descriptor_ = retried(
        [&] { return ::open(file.temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode); });
    if (file.descriptor_ >= 0) break;
    const int error = errno;
    set_slot(std::exchange(file.slot_, -1), Slot::kFree);
    // A killed process with the same number may have left the name behind.
    if (error != EEXIST) return output_error("it cannot be written: " + reason(error));
  }
  set_slot(file.slot_, Slot::kLive);
  // What the process's mask took away.
  if (exists) (void)retried([&] { return ::fchmod(file.descriptor_, mode); });
  return file;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      slot_(std::exchange(other.slot_, -1)),
      no_clobber_(other.no_clobber_) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this == &other) return *this;
  discard();
  target_ = std::move(other.target_);
  temporary_ = std::move(other.temporary_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  slot_ = std::exchange(other.slot_, -1);
  no_clobber_ = other.no_clobber_;
  return *this;
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (slot_ < 0) return;
  (void)retried([&] { return ::unlink(temporary_.c_str()); });
  set_slot(std::exchange(slot_, -1), Slot::kFree);
}

Status AtomicFile::write(std::span<const std::byte> bytes) try {
  assert(descriptor_ >= 0);
  while (!bytes.empty()) {
    const ssize_t written = retried([&] { return ::write(descriptor_, bytes.data(), bytes.size()); });
    if (written < 0) return output_error("it cannot be written: " + reason(errno));
    if (written == 0) return output_error("it cannot be written: the system takes no more bytes");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Status AtomicFile::commit() try {
  assert(slot_ >= 0);
  // Memory is taken before the file gets its name, not after.
  const std::string own_folder = folder_of(target_);
  const std::string folder = own_folder.empty() ? "." : own_folder;
  const int descriptor = std::exchange(descriptor_, -1);
  int error = descriptor >= 0 && retried([&] { return ::fsync(descriptor); }) != 0 ? errno : 0;
  // close() is where some network file systems say that there was no room. Interrupted, it has closed, and
  // what was written is on the disk.
  if (descriptor >= 0 && ::close(descriptor) != 0 && errno != EINTR && error == 0) error = errno;
  // Again by name, because a library may have put another file there; unreadable files are our own.
  if (error == 0) error = sync_path(temporary_, 0);
  if (error == EACCES) error = 0;
  if (error == 0) {
    if (no_clobber_) {
      error = rename_no_replace(temporary_, target_);
      if (error == EEXIST) {
        discard();
        return output_error("it exists already and is to be kept");
      }
    } else if (retried([&] { return ::rename(temporary_.c_str(), target_.c_str()); }) != 0) {
      error = errno;
    }
  }
  if (error != 0) {
    discard();
    return output_error("it cannot be written: " + reason(error));
  }
  set_slot(std::exchange(slot_, -1), Slot::kFree);
  error = sync_path(folder, O_DIRECTORY);
  // The file is there and whole; some file systems cannot flush a folder, and a folder may be write-only.
  if (error != 0 && error != EINVAL && error != EACCES)
    return output_error("it was written, but its folder cannot be flushed: " + reason(error));
  return {};
} catch (const std::bad_alloc&) {
  discard();
  return out_of_memory();
}

Status write_file(const std::string& path, std::span<const std::byte> bytes, bool no_clobber) try {
  auto file = AtomicFile::create(path, no_clobber);
  if (!file) return file.error();
  if (Status status = file->write(bytes); !status) return status;
  return file->commit();
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

void remove_temporary_files() noexcept {
  const int saved = errno;
  for (Slot& slot : slots)
    if (slot.state.load() == Slot::kLive) ::unlink(slot.path);
  errno = saved;
}

}  // namespace mesocell
