#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "converters/cli/commands.h"
#include "converters/cli/console.h"

namespace mesocell {

/// A file of a batch.
struct BatchFile {
  std::string input, output;
};

/// Whether `convert` is asked for a batch: a folder as the output, unless what goes there is one asset as
/// pictures.
[[nodiscard]] bool is_batch(const ConvertCommand& command);

/// The files of a batch in the order of the inputs, lists read. Outputs have the inputs' names with another
/// extension; where these meet, the whole names, and where those do, numbers. Untrusted lists: safe.
[[nodiscard]] std::optional<Failure> plan_batch(const ConvertCommand& command, std::vector<BatchFile>& files);

/// What a batch remembers in its folder of how files were made, so that those that are up to date can be
/// left.
class BatchRecord {
 public:
  /// That of the folder; empty if there is none, or none that can be read.
  static BatchRecord load(const std::string& folder);
  /// Errors: kOutput.
  [[nodiscard]] Status save(const std::string& folder) const;

  /// Whether the output is there as it was made of the input and all files that were read with it, as they
  /// are now, by these words.
  [[nodiscard]] bool up_to_date(const BatchFile& file, const std::string& words) const;
  /// Notes that the output was made just now, of the input and files beside it.
  void note(const BatchFile& file, const std::string& words, const std::vector<std::string>& beside);

 private:
  /// All that must be the same.
  struct Entry {
    std::string made;
    std::map<std::string, std::string> files;  ///< what they were, by their paths
  };
  std::map<std::string, Entry> made_;  ///< by the output's name
};

}  // namespace mesocell
