// Adds to the suites in FOLDER what is not in them yet: mesocell_conformance_files FOLDER. See README.md:
// what is there stays.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>
#include <stdexcept>

#include "tests/conformance/suite.h"

namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(path.string() + " cannot be written");
}

/// Adds the files of a version's suite.
void add_files(const std::filesystem::path& folder, std::string_view version,
               const std::vector<mesocell::test::Case>& cases) {
  using namespace mesocell;
  conformance::Manifest manifest = test::manifest_of(cases, version);
  // Entries of files that are there are kept as they are, also those that no case makes any more.
  conformance::Manifest there;
  if (std::filesystem::exists(folder / "manifest.json"))
    there = conformance::parse_manifest(read(folder / "manifest.json"));
  std::set<std::string> paths;
  for (const conformance::Entry& entry : there.files) paths.insert(entry.path);
  std::size_t added = 0;
  for (const test::Case& c : cases) {
    if (!test::is_file(c) || c.version != version || paths.count(test::path_of(c)) > 0) continue;
    write(folder / test::path_of(c), {reinterpret_cast<const char*>(c.bytes.data()), c.bytes.size()});
    ++added;
  }
  std::cout << version << ": " << there.files.size() << " files stay, " << added << " are added\n";
  if (added == 0) return;
  std::erase_if(manifest.files, [&](const conformance::Entry& entry) { return paths.count(entry.path) > 0; });
  manifest.files.insert(manifest.files.begin(), there.files.begin(), there.files.end());
  write(folder / "manifest.json", to_json(manifest));
}

}  // namespace

int main(int count, char** arguments) try {
  using namespace mesocell;
  if (count != 2) {
    std::cerr << "usage: mesocell_conformance_files FOLDER\n";
    return 2;
  }
  const auto cases = test::conformance_cases();
  for (const std::string_view version : test::kSuites)
    add_files(std::filesystem::path(arguments[1]) / version, version, cases);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
