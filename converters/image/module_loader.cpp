#include "converters/image/module_loader.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

namespace mesocell {
namespace {

std::vector<std::filesystem::path> module_folders() {
  std::vector<std::filesystem::path> folders;
  // Someone who names a folder means that one: no other is tried.
  if (const char* folder = std::getenv("MESOCELL_MODULE_PATH"); folder && *folder) return {folder};
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) {
    folders.push_back(program.parent_path().parent_path() / "lib" / "mesocell");
    folders.push_back(program.parent_path().parent_path() / MESOCELL_LIBDIR / "mesocell");
  }
  return folders;
}

}  // namespace

Result<std::string> find_module_file(const std::string& file) {
  std::string tried;
  for (const std::filesystem::path& folder : module_folders()) {
    const std::filesystem::path path = folder / file;
    std::error_code error;
    if (std::filesystem::exists(path, error)) return path.string();
    tried += (tried.empty() ? "" : ", ") + path.string();
  }
  return Error{ErrorCode::kOutput,
               file + " is missing (" + tried + "); install it, or name its folder in MESOCELL_MODULE_PATH"};
}

Result<void*> load_module(const std::string& name) {
  std::string tried;
  for (const std::filesystem::path& folder : module_folders()) {
    const std::filesystem::path path = folder / (name + ".so");
    if (void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
    std::error_code error;
    const char* reason = std::filesystem::exists(path, error) ? dlerror() : "not there";
    tried += (tried.empty() ? "" : ", ") + path.string() + ": " + (reason ? reason : "unknown error");
  }
  return Error{ErrorCode::kOutput, "the module " + name + " cannot be loaded (" + tried +
                                       "); install it, or name its folder in MESOCELL_MODULE_PATH"};
}

void* find_function(void* module, const char* name) { return dlsym(module, name); }

}  // namespace mesocell
