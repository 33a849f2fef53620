#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "format/issues.h"
#include "tests/format/spec_text.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

std::string read_text(const std::string& name) {
  std::ifstream in(std::string(MESOCELL_SOURCE_DIR) + "/spec/" + name);
  REQUIRE(in.good());
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("spec: issues.md is the catalogue (mesocell_spec_text rewrites it)") {
  CHECK(read_text("issues.md") == issue_catalogue_markdown());
}

TEST_CASE("spec: the bytes of the walk-through are the file that the writer makes") {
  const std::string spec = read_text("mesocell-1.md");
  Bytes bytes;
  std::istringstream lines(spec.substr(spec.find(kWalkthroughBegin)));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("    0", 0) != 0) continue;
    std::istringstream numbers(line);
    std::string number;
    REQUIRE(numbers >> number);
    REQUIRE(std::stoul(number, nullptr, 16) == bytes.size());
    while (numbers >> number) bytes.push_back(std::byte(std::stoul(number, nullptr, 16)));
  }
  CHECK(bytes == encoded(walkthrough_object()));
  CHECK(spec.find(walkthrough_markdown()) != std::string::npos);
}

TEST_CASE("spec: every clause of the catalogue is a section of the spec") {
  const std::string spec = read_text("mesocell-1.md");
  for (const IssueInfo& info : issue_catalogue()) {
    CAPTURE(info.id, info.clause);
    CHECK(spec.find("\n" + std::string(info.clause.find('.') == std::string::npos ? "## " : "### ") +
                    std::string(info.clause) + " ") != std::string::npos);
  }
}
