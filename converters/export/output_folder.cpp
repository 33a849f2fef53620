#include "converters/export/output_folder.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "format/file.h"

namespace mesocell {
namespace {

Error output(std::string message) { return Error{ErrorCode::kOutput, std::move(message)}; }

std::string without_slash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

}  // namespace

Result<OutputFolder> OutputFolder::create(const std::string& path, bool no_clobber) {
  OutputFolder folder;
  folder.target_ = without_slash(path);
  std::error_code error;
  const std::filesystem::path target = folder.target_;
  if (std::filesystem::exists(target, error)) {
    if (no_clobber) return output("it exists, and is not to be replaced");
    if (!std::filesystem::is_directory(target, error))
      return output("it is there and no folder; name another one");
    if (!std::filesystem::is_empty(target, error) || error)
      return output("there are files in this folder; empty it, or name another one");
  }
  const std::filesystem::path parent = target.has_parent_path() ? target.parent_path() : ".";
  std::string name = (parent / ".mesocell-XXXXXX").string();
  if (!mkdtemp(name.data()))
    return output(std::string("no folder can be made there (") + std::strerror(errno) + ")");
  folder.temporary_ = name;
  std::filesystem::permissions(name, std::filesystem::perms(0755), error);
  return folder;
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : target_(std::move(other.target_)), temporary_(std::exchange(other.temporary_, {})) {}

OutputFolder::~OutputFolder() {
  std::error_code error;
  if (!temporary_.empty()) std::filesystem::remove_all(temporary_, error);
}

Status OutputFolder::write(const std::string& name, std::span<const std::byte> bytes) {
  return write_file((std::filesystem::path(temporary_) / name).string(), bytes);
}

Status OutputFolder::commit() {
  std::error_code error;
  std::filesystem::rename(temporary_, target_, error);  // onto an empty folder, too
  if (error) return output("it cannot be given its name (" + error.message() + ")");
  temporary_.clear();
  return {};
}

}  // namespace mesocell
