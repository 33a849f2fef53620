#include <filesystem>

#include "converters/cli/commands.h"
#include "converters/image/extension.h"
#include "format/file.h"

namespace mesocell {

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error)) return true;
  return std::filesystem::weakly_canonical(a, error) == std::filesystem::weakly_canonical(b, error);
}

bool has_extension(const std::string& path, std::string_view extension) {
  return lower_extension(path) == extension;
}

Status check_output(const std::string& path, bool no_clobber) {
  const Result<AtomicFile> file = AtomicFile::create(path, no_clobber);
  return file ? Status() : Status(file.error());
}

Result<std::vector<std::byte>> read_input(const std::string& path, std::uint64_t max_bytes) {
  Result<std::vector<std::byte>> bytes = read_file(path, max_bytes);
  if (bytes || bytes.error().code != ErrorCode::kUnreadable ||
      bytes.error().message.find("; ") != std::string::npos)
    return bytes;
  Error error = bytes.error();
  error.message += "; check its name and permissions";
  return error;
}

}  // namespace mesocell
