#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <utility>

namespace mesocell {

/// What a reader has to say beside what it read.
struct ReadNotes {
  static constexpr std::size_t kMaxLosses = 32;

  /// Paths of the files beside the one that was asked for that were read, or looked for in vain because that
  /// one names them.
  std::set<std::string> files;
  /// What is in the file but was passed over: "normals", "grid density". Names in it are the file's own, and
  /// may hold anything.
  std::set<std::string> losses;

  /// What is beyond kMaxLosses is not noted.
  void lose(std::string what) {
    if (losses.size() < kMaxLosses) losses.insert(std::move(what));
  }
  void add(const ReadNotes& other) {
    files.insert(other.files.begin(), other.files.end());
    for (const std::string& loss : other.losses) lose(loss);
  }
};

}  // namespace mesocell
