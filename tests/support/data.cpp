#include "tests/support/data.h"

#include <cstdlib>
#include <filesystem>

namespace mesocell::test {

std::optional<std::string> find_data(const std::string& name) {
  const char* const set = std::getenv("MESOCELL_TEST_DATA");
  const std::filesystem::path folder =
      set ? std::filesystem::path(set)
          : std::filesystem::path(MESOCELL_SOURCE_DIR) / ".." / "shared" / "data";
  const std::filesystem::path path = folder / name;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  return path.string();
}

}  // namespace mesocell::test
