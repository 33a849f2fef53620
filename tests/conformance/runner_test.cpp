#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/conformance/runner.h"
#include "tests/support/catch.h"

using namespace mesocell::conformance;

namespace {

const std::string kDigest = "0123456789abcdef";

Manifest manifest() {
  Manifest m;
  m.version = "1.0";
  m.rules = {{"grid-box", "4.10", "error", "a \"box\" of no \\ extent"}};
  m.files = {{"valid/a/1.meso", "valid", "3.1", "", {}, kDigest, 64, kDigest},
             {"invalid/grid-box/1.meso", "invalid", "4.10", "grid-box", {"grid-box", "x"}, kDigest, 1, ""},
             {"invalid/grid-box/2.meso", "invalid", "4.9", "grid-box", {"grid-box"}, kDigest, 1, ""},
             {"limit/b/1.meso", "limit", "6", "", {}, kDigest, 64, ""}};
  for (Entry& entry : m.files) entry.folder = "/tmp/nowhere";
  return m;
}

struct Outcome {
  int status;
  std::string text;
  [[nodiscard]] bool has(const std::string& part) const { return text.find(part) != std::string::npos; }
};

/// Time for a reader that hangs; others get more than they need on a busy machine.
constexpr std::chrono::milliseconds kShort(700), kLong(20000);

Outcome run_with(const std::string& command, bool ids = false, const std::string& only = {},
                 std::chrono::milliseconds time = kLong) {
  ::signal(SIGPIPE, SIG_IGN);
  std::ostringstream out;
  const int status = run(manifest(), {command, only, ids, time}, out);
  return {status, out.str()};
}

/// A reader in sh that answers by the path in `p`.
std::string reader(const std::string& valid, const std::string& invalid, const std::string& limit) {
  return "while read -r p; do case $p in */valid/*) " + valid + ";; */invalid/*) " + invalid + ";; *) " +
         limit + ";; esac; done";
}
const std::string kRight = reader("echo valid " + kDigest, "echo invalid grid-box", "echo limit");

}  // namespace

TEST_CASE("conformance: a manifest is read as it was written") {
  const std::string json = to_json(manifest());
  CHECK(to_json(parse_manifest(json)) == json);
  CHECK(parse_manifest(json).rule_text("grid-box") == manifest().rules[0].text);
  CHECK(parse_manifest(json).files[1].report.size() == 2);
  for (std::size_t size = 0; size + 1 < json.size(); ++size) {
    INFO(size);
    CHECK_THROWS_AS(parse_manifest(json.substr(0, size)), std::runtime_error);
  }
  CHECK_THROWS_AS(parse_manifest(json + "x"), std::runtime_error);
  CHECK_THROWS_AS(parse_manifest("{\"files\": [{\"pth\": \"x\"}]}"), std::runtime_error);
}

TEST_CASE("conformance: an answer must be of the protocol and right") {
  const auto files = manifest().files;
  const auto right = [&](std::size_t file, const std::string& answer, bool ids = false) {
    return fault_of_answer(files[file], answer, ids).empty();
  };
  CHECK(right(0, "valid " + kDigest));
  for (const char* bad :
       {"valid", "valid ", "valid 0", "valid 0123456789abcdeF", "valid 1123456789abcdef", "Valid", "",
        "valid  0123456789abcdef", "valid 0123456789abcdef ", "invalid", "limit"})
    CHECK_FALSE(right(0, bad));
  CHECK(right(1, "invalid"));
  CHECK(right(1, "invalid anything"));
  for (const char* bad : {"invalid ", "invalid two words", "limit", "valid 0123456789abcdef", "invalidated"})
    CHECK_FALSE(right(1, bad));
  CHECK(right(1, "invalid x", true));
  CHECK_FALSE(right(1, "invalid", true));
  CHECK_FALSE(right(2, "invalid x", true));
  CHECK(right(3, "limit"));
  CHECK_FALSE(right(3, "limit grid-box"));
}

TEST_CASE("conformance: the runner counts what passed and failed") {
  const Outcome right = run_with(kRight, true);
  CHECK(right.status == 0);
  CHECK(right.text ==
        "clause   passed   failed\n3.1           1        0\n4.9           1        0\n4.10          1       "
        " 0\n"
        "6             1        0\n4 passed, 0 failed\n");
  const Outcome taken = run_with(reader("echo valid " + kDigest, "echo valid " + kDigest, "echo limit"));
  CHECK(taken.status == 1);
  CHECK(taken.has("FAILED invalid/grid-box/1.meso"));
  CHECK(taken.has("clause 4.10: grid-box, a \"box\" of no"));
  CHECK(taken.has("\n2 passed, 2 failed\n"));
  CHECK(run_with(reader("echo valid 0000000000000000", "echo invalid", "echo limit"))
            .has("it holds something else"));
  CHECK(run_with(kRight, true, "grid-box/").has("\n2 passed, 0 failed\n"));
  CHECK(run_with(kRight, true, "invalid/grid-box/2").has("\n1 passed, 0 failed\n"));
  CHECK(run_with(kRight, true, "nothing").status == 2);
}

TEST_CASE("conformance: a reader that crashes, hangs or babbles fails one file, and the run goes on") {
  const auto with_invalid = [](const std::string& what, std::chrono::milliseconds time) {
    return run_with(reader("echo valid " + kDigest, what, "echo limit"), false, {}, time);
  };
  const auto check = [&](const std::string& what, std::chrono::milliseconds time, const std::string& fault) {
    CAPTURE(what);
    const Outcome outcome = with_invalid(what, time);
    CAPTURE(outcome.text);
    CHECK(outcome.status == 1);
    CHECK(outcome.has("\n2 passed, 2 failed\n"));
    CHECK(outcome.has(fault));
  };
  check("kill -9 $$", kLong, "ended by signal 9");
  check("exit 3", kLong, "ended with status 3");
  check("printf inval; exit", kLong, "in the middle of a line");
  check("sleep 9 & kill -9 $$", kLong, "ended by signal 9");
  check("exec >&-; sleep 9", kLong, "closed its output");
  check("printf 'invalid\\ninv'", kLong, "more than one line");
  check("echo invalid sounds bad", kLong, "not an answer of the protocol");
  check("echo", kLong, "not an answer of the protocol");
  check("yes | tr -d '\\n'", kLong, "has no end");
  check("sleep 9", kShort, "not answer in time");
  check("printf invalid; sleep 9", kShort, "not answer in time");
}

TEST_CASE("conformance: a reader that never answers is given up") {
  for (const char* command : {"exit 0", "/nowhere/reader", "sleep 9", "exec <&-; exit 1"}) {
    CAPTURE(command);
    const auto begin = std::chrono::steady_clock::now();
    CHECK(run_with(command, false, {}, kShort).status == 2);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(9));
  }
}
