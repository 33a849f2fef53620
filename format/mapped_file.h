#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "format/api.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// A file as read-only memory, without a copy: for large files, and for engines that read some chunks alone.
/// read_file() is for everything else.
///
/// If the file becomes shorter, or its disk fails, touching what is lost raises SIGBUS. The first open() of a
/// process installs a handler for it, for good: it puts zeros in the place of everything from the lost page
/// to the end of the mapping, so that readers go on and find a damaged file, and check() tells. Whoever reads
/// a mapped file checks afterwards: if check() succeeds, what was read is what the file held. (A change that
/// keeps the size is seen by the time of change, whose step is some milliseconds on most file systems.)
///
/// - A SIGBUS of other memory goes to the handler that was there before the first open(), or kills as it did.
/// - A program that installs its own handler later calls handle_fault() first in it, or else calls the
///   handler that sigaction() found. Threads that read must not block SIGBUS.
/// - System calls that are given lost memory fail with EFAULT instead.
/// - Untrusted bytes are as safe as in a vector. An untrusted process that may write the file while it is
///   read is not: it can change bytes between two looks at them. Use read_file() there.
///
/// A file that is replaced as AtomicFile does it, by another file of its name, stays whole for those who have
/// mapped it. Each mapping keeps a file descriptor. Constant, thus for any number of threads at once.
class MappedFile {
 public:
  /// Errors: kUnreadable (missing, no permission, a folder; pipes and devices, which read_file() takes),
  /// kLimit (more than `max_bytes`, no address space, more than 1024 files mapped at once).
  /// An empty file is no error.
  [[nodiscard]] static Result<MappedFile> open(const std::string& path, std::uint64_t max_bytes);

  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  /// As many bytes as the file had in open(). Valid as long as this object, also after moving it.
  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Whether bytes() have been those of the file since open(): nothing was lost, its size and time of change
  /// are the same. Errors: kUnreadable.
  [[nodiscard]] Status check() const;

  /// For a program's own handler of SIGBUS, with siginfo_t::si_addr: true if the address is in a mapped file,
  /// zeros are there now, and the handler is to return. Async-signal-safe.
  static bool handle_fault(const void* address) noexcept;

 private:
  MappedFile() = default;
  void close() noexcept;

  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::int64_t changed_seconds_ = 0;
  std::int64_t changed_nanoseconds_ = 0;
  int descriptor_ = -1;
  int slot_ = -1;
};

}  // namespace mesocell
