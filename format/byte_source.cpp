#include "format/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <new>
#include <utility>

#include "format/byte_reader.h"
#include "format/system_call.h"

namespace mesocell {

Result<FileSource> FileSource::open(const std::string& path) try {
  FileSource source;
  source.descriptor_ = retried([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK); });
  if (source.descriptor_ < 0) return unreadable("it cannot be opened: " + reason(errno));
  struct stat info {};
  if (::fstat(source.descriptor_, &info) != 0) return unreadable("it cannot be read: " + reason(errno));
  if (S_ISDIR(info.st_mode)) return unreadable("it is a folder; give a file");
  if (!S_ISREG(info.st_mode)) return unreadable("only regular files can be read in parts");
  source.size_ = static_cast<std::uint64_t>(info.st_size);
  return source;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

FileSource::FileSource(FileSource&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_), bytes_read_(other.bytes_read_) {}

FileSource& FileSource::operator=(FileSource&& other) noexcept {
  if (this == &other) return *this;
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  size_ = other.size_;
  bytes_read_ = other.bytes_read_;
  return *this;
}

FileSource::~FileSource() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status FileSource::read(std::uint64_t offset, std::span<std::byte> to) try {
  assert(offset <= size_ && to.size() <= size_ - offset);
  while (!to.empty()) {
    const ssize_t got =
        retried([&] { return ::pread(descriptor_, to.data(), to.size(), static_cast<off_t>(offset)); });
    if (got < 0) return unreadable("it cannot be read: " + reason(errno));
    if (got == 0) return unreadable("it became shorter while it was read");
    to = to.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
    bytes_read_ += static_cast<std::uint64_t>(got);
  }
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Status SpanSource::read(std::uint64_t offset, std::span<std::byte> to) {
  const auto from = slice(bytes_, offset, to.size());
  std::copy(from.begin(), from.end(), to.begin());
  return {};
}

}  // namespace mesocell
