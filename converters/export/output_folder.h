#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "format/result.h"

namespace mesocell {

/// A folder of files that appears under its name whole or not at all: it is filled under a temporary name
/// beside it. A folder that is there is replaced only if it is empty.
class OutputFolder {
 public:
  /// Errors: kOutput (something with files in it, or that is no folder, is there; no permission).
  [[nodiscard]] static Result<OutputFolder> create(const std::string& path, bool no_clobber = false);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) = delete;
  ~OutputFolder();

  /// Errors: kOutput.
  [[nodiscard]] Status write(const std::string& name, std::span<const std::byte> bytes);
  /// Gives the folder its name. At most once.
  [[nodiscard]] Status commit();

 private:
  OutputFolder() = default;
  std::string target_, temporary_;
};

}  // namespace mesocell
