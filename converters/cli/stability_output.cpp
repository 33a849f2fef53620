#include "converters/cli/stability_output.h"

#include <algorithm>
#include <span>

#include "format/file.h"

namespace mesocell {

std::optional<Failure> check_stability_outputs(const StabilityCommand& command) {
  if (!command.picture.empty() && !has_extension(command.picture, ".svg"))
    return usage("--picture", "'" + command.picture + "' is no .svg file; give its name that extension");
  for (const std::string& path : {command.csv, command.markdown, command.picture})
    if (!path.empty())
      if (const Status status = check_output(path, command.no_clobber); !status)
        return Failure{status.error(), path};
  return std::nullopt;
}

std::optional<Failure> write_stability(const StabilityCommand& command, const std::string& csv,
                                       const std::string& markdown, const std::string& picture) {
  for (const auto& [path, text] : {std::pair(command.csv, csv), std::pair(command.markdown, markdown),
                                   std::pair(command.picture, picture)}) {
    if (path.empty()) continue;
    if (const Status status = write_file(path, std::as_bytes(std::span(text)), command.no_clobber); !status)
      return Failure{status.error(), path};
  }
  return std::nullopt;
}

}  // namespace mesocell
