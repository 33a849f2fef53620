#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

#include "tests/conformance/manifest.h"

namespace mesocell::conformance {

struct RunOptions {
  std::string command;  ///< of the reader, for sh -c
  std::string only;     ///< files whose path, with or without the verdict's folder, begins with this
  bool ids = false;     ///< issue ids are compared
  std::chrono::milliseconds time{10000};
};

/// What is wrong with an answer; empty if it is right.
[[nodiscard]] std::string fault_of_answer(const Entry& entry, const std::string& answer, bool ids);

/// Asks a reader about all files and prints failures, a table by clause and the closing line. Returns 0 if
/// all passed, 1 if one failed, 2 if there is no file to be asked about or the reader never answers.
int run(const Manifest& manifest, const RunOptions& options, std::ostream& out);

}  // namespace mesocell::conformance
