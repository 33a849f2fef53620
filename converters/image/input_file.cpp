#include "converters/image/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace mesocell {

Result<InputFile> InputFile::open(const std::string& path, std::uint64_t max_bytes) {
  const auto unreadable = [](int error) {
    return Error{ErrorCode::kUnreadable,
                 std::generic_category().message(error) + "; check its name and permissions"};
  };
  InputFile file;
  // Opening a pipe would wait for a writer.
  file.descriptor_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file.descriptor_ < 0) return unreadable(errno);
  struct stat info {};
  if (::fstat(file.descriptor_, &info) != 0) return unreadable(errno);
  if (!S_ISREG(info.st_mode))
    return Error{ErrorCode::kUnreadable, "it is not a file; check its name and permissions"};
  file.size_ = std::uint64_t(info.st_size);
  if (file.size_ > max_bytes)
    return Error{ErrorCode::kLimit,
                 "the file is over the limit of " + std::to_string(max_bytes) + " bytes; use a smaller one"};
  return file;
}

InputFile::InputFile(InputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool InputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (offset > size_ || bytes.size() > size_ - offset) return false;
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += std::uint64_t(got);
    bytes = bytes.subspan(std::size_t(got));
  }
  return true;
}

}  // namespace mesocell
