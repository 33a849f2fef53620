// Writes the suite: mesocell_conformance_files FOLDER. See README.md: what was published is never written
// again.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "tests/conformance/suite.h"

namespace {

void write(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(path.string() + " cannot be written");
}

}  // namespace

int main(int count, char** arguments) try {
  using namespace mesocell;
  if (count != 2) {
    std::cerr << "usage: mesocell_conformance_files FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  const auto cases = test::conformance_cases();
  const conformance::Manifest manifest = test::manifest_of(cases);
  std::size_t bytes = 0;
  for (const test::Case& c : cases) {
    if (!test::is_file(c)) continue;
    write(folder / test::path_of(c), {reinterpret_cast<const char*>(c.bytes.data()), c.bytes.size()});
    bytes += c.bytes.size();
  }
  write(folder / "manifest.json", to_json(manifest));
  std::cout << manifest.files.size() << " files of " << bytes << " bytes; "
            << cases.size() - manifest.files.size() << " cases are too large or have limits of their own\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
