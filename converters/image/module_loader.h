#pragma once

#include <string>

#include "format/result.h"

namespace mesocell {

/// The path of a file in the folder of modules, "mesocell_image.so": that in MESOCELL_MODULE_PATH, else
/// ../lib/mesocell beside the program's folder, else where it was installed. Errors: kOutput with the places
/// that were tried.
[[nodiscard]] Result<std::string> find_module_file(const std::string& file);

/// Loads a module by name, e.g. "mesocell_image", from the folder in MESOCELL_MODULE_PATH, else from
/// ../lib/mesocell beside the program's folder, else from where it was installed. It stays loaded.
/// Errors: kOutput with the places that were tried.
[[nodiscard]] Result<void*> load_module(const std::string& name);

/// The address of a function of the module, null if it has none of that name.
[[nodiscard]] void* find_function(void* module, const char* name);

}  // namespace mesocell
