#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// The bytes of a file, pipe or device. Errors: kUnreadable (missing, a folder, no permission, read error,
/// or shorter at its end than at its beginning), kLimit (more than `max_bytes`, found before memory is taken;
/// out of memory). An empty file is no error.
[[nodiscard]] Result<std::vector<std::byte>> read_file(const std::string& path, std::uint64_t max_bytes);

/// A file that appears under its name whole or not at all. Bytes go to a temporary name in the same folder
/// with the same extension (if that has at most 64 bytes), which commit() turns into the target's; without
/// commit() it is removed. A symbolic link as target stays, what it points to is replaced. A target that is
/// there and is not a regular file is refused. Errors are kOutput with the system's reason, and kLimit out of
/// memory.
///
/// A process that is killed leaves a file `.mesocell-*` behind. It disturbs no later one, and none removes
/// it: the process number in its name says nothing to another machine or container that shares the folder, a
/// clock of another machine not how old it is, and a lock is lost where a library puts a file of its own
/// there.
class AtomicFile {
 public:
  /// `no_clobber`: an existing target is an error, here and in commit().
  [[nodiscard]] static Result<AtomicFile> create(const std::string& path, bool no_clobber = false);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// For libraries that write by name; they may replace the file that is there.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }
  /// Appends.
  [[nodiscard]] Status write(std::span<const std::byte> bytes);
  /// Flushes the file to the disk, gives it its name and flushes the folder. At most once.
  [[nodiscard]] Status commit();

 private:
  AtomicFile() = default;
  void discard() noexcept;

  std::string target_;
  std::string temporary_;
  int descriptor_ = -1;
  int slot_ = -1;
  bool no_clobber_ = false;
};

/// Writes all bytes to `path` through an AtomicFile. Errors: as there; the file is then as it was, unless the
/// message says that it was written.
[[nodiscard]] Status write_file(const std::string& path, std::span<const std::byte> bytes,
                                bool no_clobber = false);

/// Removes the temporary files of all AtomicFiles that are open in this process. Async-signal-safe: for a
/// signal handler or an exit path that runs no destructors.
void remove_temporary_files() noexcept;

}  // namespace mesocell
