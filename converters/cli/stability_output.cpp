#include "converters/cli/stability_output.h"

#include <algorithm>
#include <span>

#include "format/file.h"

namespace mesocell {

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t comma = std::min(list.find(',', begin), list.size());
    if (comma > begin) words.push_back(list.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return words;
}

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
