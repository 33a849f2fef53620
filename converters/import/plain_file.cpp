#include "converters/import/plain_file.h"

#include <filesystem>

#include "format/file.h"

namespace mesocell {

Result<std::vector<std::byte>> read_plain_file(const std::string& path, std::uint64_t max_bytes) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return Error{ErrorCode::kUnreadable, "there is no such file; check the name"};
  if (status.type() == std::filesystem::file_type::directory)
    return Error{ErrorCode::kUnreadable, "it is a folder; name a file in it"};
  if (error)
    return Error{ErrorCode::kUnreadable,
                 "it cannot be reached (" + error.message() + "); check its permissions"};
  if (status.type() != std::filesystem::file_type::regular)
    return Error{ErrorCode::kUnreadable, "it is not a regular file; copy its content into one"};
  return read_file(path, max_bytes);
}

}  // namespace mesocell
