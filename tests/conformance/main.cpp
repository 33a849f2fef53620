// conformance --reader COMMAND [--manifest FILE]... [--only PREFIX] [--ids] [--timeout SECONDS]: see
// README.md.
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/conformance/runner.h"

namespace {

constexpr const char* kUsage =
    "usage: conformance --reader COMMAND [--manifest FILE]... [--only PREFIX] [--ids] [--timeout SECONDS]\n";

double seconds(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != 0 || !(value > 0) || value > 86400)
    throw std::invalid_argument("--timeout needs seconds, more than none and at most a day");
  return value;
}

}  // namespace

int main(int count, char** arguments) try {
  using namespace mesocell::conformance;
  RunOptions options;
  std::vector<std::string> manifests;
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    if (word == "--help") {
      std::cout << kUsage;
      return 0;
    }
    if (word == "--ids") {
      options.ids = true;
      continue;
    }
    if (word != "--reader" && word != "--manifest" && word != "--only" && word != "--timeout")
      throw std::invalid_argument("unknown: " + word);
    if (++i == count) throw std::invalid_argument(word + " needs a value");
    const std::string value = arguments[i];
    if (word == "--reader") options.command = value;
    if (word == "--manifest") manifests.push_back(value);
    if (word == "--only") options.only = value;
    if (word == "--timeout")
      options.time = std::chrono::milliseconds(std::max(1L, long(1000 * seconds(value))));
  }
  if (options.command.empty()) throw std::invalid_argument("--reader is missing");
  if (manifests.empty()) {
    for (const char* version : {"1.0", "1.1"})
      manifests.push_back(MESOCELL_CONFORMANCE_FOLDER "/" + std::string(version) + "/manifest.json");
  }
  Manifest all;
  for (const std::string& file : manifests) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(file + " cannot be read");
    const std::string json(std::istreambuf_iterator<char>(in), {});
    Manifest manifest = parse_manifest(json);
    for (Entry& entry : manifest.files) entry.folder = std::filesystem::absolute(file).parent_path().string();
    all.rules.insert(all.rules.end(), manifest.rules.begin(), manifest.rules.end());
    all.files.insert(all.files.end(), manifest.files.begin(), manifest.files.end());
  }
  ::signal(SIGPIPE, SIG_IGN);  // a reader that has ended is a failure of a file and not of the run
  return run(all, options, std::cout);
} catch (const std::invalid_argument& error) {
  std::cerr << error.what() << '\n' << kUsage;
  return 2;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
