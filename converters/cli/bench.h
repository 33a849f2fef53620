#pragma once

#include <string>

namespace mesocell {

/// What stands below the options: sets, scenes, cameras, rays, methods, columns, keys of --json, examples.
[[nodiscard]] std::string bench_help();

}  // namespace mesocell
