#pragma once

#include <set>
#include <string>

namespace mesocell {

/// What a reader has to say beside what it read.
struct ReadNotes {
  /// Paths of the files beside the one that was asked for that were read, or looked for in vain because that
  /// one names them.
  std::set<std::string> files;

  void add(const ReadNotes& other) { files.insert(other.files.begin(), other.files.end()); }
};

}  // namespace mesocell
