#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "format/hash.h"
#include "tests/conformance/digest.h"
#include "tests/conformance/suite.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;
namespace fs = std::filesystem;

namespace {

const fs::path kFolder = MESOCELL_CONFORMANCE_FOLDER;

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The entries of all suites, by their paths from kFolder.
std::vector<conformance::Entry> frozen() {
  std::vector<conformance::Entry> all;
  for (const std::string_view version : kSuites) {
    const auto manifest = conformance::parse_manifest(read_text(kFolder / version / "manifest.json"));
    CHECK(manifest.version == version);
    for (conformance::Entry entry : manifest.files) {
      entry.path = std::string(version) + "/" + entry.path;
      all.push_back(std::move(entry));
    }
  }
  return all;
}

}  // namespace

TEST_CASE("conformance: the files are those of the manifest, byte for byte") {
  const std::vector<conformance::Entry> files = frozen();
  CHECK(files.size() >= 1800);
  std::set<std::string> paths;
  std::uint64_t bytes = 0;
  for (const conformance::Entry& entry : files) {
    const std::string file = read_text(kFolder / entry.path);
    bytes += file.size();
    if (!paths.insert(entry.path).second) FAIL_CHECK(entry.path << " is listed twice");
    if (file.size() != entry.bytes || file.size() > kMostFileBytes ||
        conformance::hex16(hash64(std::as_bytes(std::span(file)))) != entry.xxh64)
      FAIL_CHECK(entry.path << " is not what the manifest says");
  }
  CHECK(bytes <= 3u << 20);
  for (const auto& item : fs::recursive_directory_iterator(kFolder)) {
    if (!item.is_regular_file() || item.path().extension() != ".meso") continue;
    const std::string path = item.path().lexically_relative(kFolder).generic_string();
    if (paths.count(path) == 0) FAIL_CHECK(path << " is not in the manifest");
  }
}

TEST_CASE("conformance: frozen files keep their verdict, report and content") {
  for (const conformance::Entry& entry : frozen()) {
    const std::string text = read_text(kFolder / entry.path);
    const auto file = std::as_bytes(std::span(text));
    const Verdicts v = verdicts(file);
    std::string wrong;
    if (!v.agree) wrong = v.why;
    if (v.reader != (entry.verdict == "valid") || v.limit != (entry.verdict == "limit"))
      wrong = "another verdict";
    std::vector<std::string> report = entry.report;
    // 1.1 was newer than what there was when the files were frozen.
    const bool known = text.size() > 11 && text[10] == 1 && text[11] == 0;
    if (known) std::erase(report, "version-newer");
    if (!entry.issue.empty() && !v.has(entry.issue) && !(known && entry.issue == "version-newer"))
      wrong = "the issue is not reported";
    if (report_of(file) != report) wrong = "another report";
    if (wrong.empty() && v.reader) {
      const auto chunks = digest_of_chunks(file), objects = digest_of_objects(file);
      if (!chunks || conformance::hex16(*chunks) != entry.digest || !objects || *objects != *chunks)
        wrong = "other content";
    }
    if (!wrong.empty()) FAIL_CHECK(entry.path << ": " << wrong);
  }
}

TEST_CASE("conformance: every case that is a file is among the frozen ones") {
  // The zstd library makes some: those are found by name, the others with the same bytes.
  std::map<std::string, std::string> frozen_files;
  for (const conformance::Entry& entry : frozen()) frozen_files[entry.path] = entry.xxh64;
  for (const Case& c : conformance_cases()) {
    if (!is_file(c)) continue;
    const auto at = frozen_files.find(std::string(c.version) + "/" + path_of(c));
    const bool by_library = c.name.starts_with("zstd/library-");
    if (at == frozen_files.end())
      FAIL_CHECK(c.name << " is not there: add it, and change no other");
    else if (!by_library && at->second != conformance::hex16(hash64(c.bytes)))
      FAIL_CHECK(c.name << " has other bytes: give the new case a new name");
  }
}
