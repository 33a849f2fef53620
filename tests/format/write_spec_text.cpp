#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "format/file.h"
#include "format/issues.h"
#include "tests/format/spec_text.h"

using namespace mesocell;

/// Rewrites spec/issues.md and the walk-through in spec/mesocell-1.md after a change of the code.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: mesocell_spec_text SPEC_FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  const auto write = [](const std::string& path, const std::string& text) {
    const Status status = write_file(path, std::as_bytes(std::span(text)));
    if (!status) std::fprintf(stderr, "%s: %s\n", path.c_str(), status.error().message.c_str());
    return status.ok();
  };
  const std::string path = folder + "/mesocell-1.md";
  std::ifstream in(path);
  std::string spec{std::istreambuf_iterator<char>(in), {}};
  const auto begin = spec.find(test::kWalkthroughBegin), end = spec.find(test::kWalkthroughEnd);
  if (begin == std::string::npos || end == std::string::npos) {
    std::fprintf(stderr, "%s: the marks of the generated part are missing\n", path.c_str());
    return 3;
  }
  const auto from = begin + std::string(test::kWalkthroughBegin).size();
  spec.replace(from, end - from, test::walkthrough_markdown());
  return write(folder + "/issues.md", issue_catalogue_markdown()) && write(path, spec) ? 0 : 4;
}
