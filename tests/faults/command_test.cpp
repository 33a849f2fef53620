#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "sdk/core/triangle_mesh.h"
#include "tests/cli/run_command.h"
#include "tests/faults/call_faults.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

constexpr std::size_t kBlock = 512;  ///< of ulimit -f
constexpr const char* kOld = "the old output";

/// A run of the command that reads a file and may write one.
struct Job {
  std::vector<std::string> arguments;
  std::string input;
  std::string output;        ///< empty if it writes none
  bool interrupted = false;  ///< calls that are interrupted, too
};

std::string name_of(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// Makes each call of each kind fail, until none is left, and looks at how the command ends. Returns how
/// often it failed with exit code 3 and 4.
struct Ends {
  int input = 0;
  int output = 0;
};
Ends each_call_fails(const TempFolder& folder, const Job& job) {
  Ends ends;
  if (!job.output.empty()) folder.write(name_of(job.output), kOld);
  const std::vector<std::string> all_files = folder.list();
  const Run good = run_command(job.arguments);
  REQUIRE(good.exit == 0);
  const std::string wanted = job.output.empty() ? std::string() : read_bytes(job.output);
  CHECK(wanted != kOld);
  struct Fault {
    Call call;
    const char* error;
    const char* cause;  ///< empty where nothing is to go wrong
  };
  std::vector<Fault> faults = {{Call::kOpen, "EIO", "Input/output error"},
                               {Call::kRead, "EIO", "Input/output error"}};
  if (!job.output.empty()) {
    faults.push_back({Call::kWrite, "ENOSPC", "No space left on device"});
    faults.push_back({Call::kSync, "EDQUOT", "Disk quota exceeded"});
    faults.push_back({Call::kRename, "EIO", "Input/output error"});
  }
  if (job.interrupted)
    for (const Call call : {Call::kRead, Call::kWrite, Call::kSync}) faults.push_back({call, "EINTR", ""});
  for (const auto& [call, error, cause] : faults)
    for (int nth = 1;; ++nth) {
      const TempFolder notes;
      const std::string kind = kCallNames[unsigned(call)];
      if (!job.output.empty()) folder.write(name_of(job.output), kOld);
      RunOptions options;
      options.environment = {
          "LD_PRELOAD=" MESOCELL_FAULT_PRELOAD,
          "MESOCELL_FAULT=" + kind + " " + std::to_string(nth) + " " + error + " " + folder.path(),
          "MESOCELL_FAULT_MARK=" + notes.file("mark"),
          // The sanitizer need not be the first library to see what the command does wrong.
          "ASAN_OPTIONS=detect_leaks=0:verify_asan_link_order=0"};
      const Run run = run_command(job.arguments, options);
      const bool failed = !notes.list().empty();
      INFO(kind << " number " << nth << " ends with " << error << "; exit " << run.exit << ": " << run.err);
      CHECK(folder.list() == all_files);
      if (!failed || *cause == '\0') CHECK(run.exit == 0);
      const std::string output = job.output.empty() ? std::string() : read_bytes(job.output);
      if (run.exit == 0) {
        CHECK((output == wanted));
        if (job.output.empty()) CHECK(run.out == good.out);
      } else if (run.exit == 3) {
        CHECK(run.err.find(job.input) != std::string::npos);
        CHECK(run.err.find(cause) != std::string::npos);
        CHECK((output == (job.output.empty() ? "" : kOld)));
        ++ends.input;
      } else {
        CHECK(run.exit == 4);
        CHECK(run.err.find(job.output) != std::string::npos);
        CHECK(run.err.find(cause) != std::string::npos);
        const bool written = run.err.find("it was written") != std::string::npos;
        CHECK((output == (written ? wanted : kOld)));
        ++ends.output;
      }
      if (!failed) break;
      REQUIRE(nth < 200);
    }
  CHECK(folder.list() == all_files);
  return ends;
}

std::string write_mesh(const TempFolder& folder) {
  return folder.write("box.obj", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.obj"));
}

std::string write_asset(const TempFolder& folder) {
  const TempFolder other;
  const std::string path = folder.file("box.meso");
  REQUIRE(run_command({"convert", write_mesh(other), path, "--tile", "bricks"}).exit == 0);
  return path;
}

}  // namespace

TEST_CASE("faults of the command: convert") {
  const TempFolder folder;
  const std::string input = write_mesh(folder);
  const std::string output = folder.file("box.meso");
  const Ends ends =
      each_call_fails(folder, {{"convert", input, output, "--tile", "bricks"}, input, output, true});
  CHECK(ends.input >= 2);
  CHECK(ends.output >= 5);
}

TEST_CASE("faults of the command: info and validate") {
  const TempFolder folder;
  const std::string input = write_asset(folder);
  CHECK(each_call_fails(folder, {{"info", input}, input, {}}).input >= 2);
  CHECK(each_call_fails(folder, {{"validate", input}, input, {}}).input >= 2);
}

TEST_CASE("faults of the command: render") {
  const TempFolder folder;
  const std::string input = write_asset(folder);
  const std::string output = folder.file("picture.png");
  const Ends ends = each_call_fails(folder, {{"render", input, output, "--size", "64x48"}, input, output});
  CHECK(ends.input >= 2);
  CHECK(ends.output >= 5);
}

TEST_CASE("faults of the command: an output that is larger than files may be is none") {
  const TempFolder folder;
  const std::string input = write_asset(folder);
  const std::string mesh = write_mesh(folder);
  const std::vector<std::vector<std::string>> jobs = {
      {"convert", mesh, folder.file("new.meso"), "--tile", "bricks"},
      {"render", input, folder.file("new.png"), "--size", "64x48"},
      {"render", input, folder.file("new.exr"), "--size", "64x48"}};
  for (const std::vector<std::string>& job : jobs) {
    const std::string& output = job[2];
    REQUIRE(run_command(job).exit == 0);
    const std::string wanted = read_bytes(output);
    int refused = 0;
    // The last block that is wanting tells whether buffered bytes are looked after.
    const std::size_t most = (wanted.size() + kBlock - 1) / kBlock;
    for (const std::size_t blocks : {std::size_t{0}, most / 2, most - 1, most}) {
      folder.write(name_of(output), kOld);
      const std::vector<std::string> files = folder.list();
      std::vector<std::string> words = {"-c", "ulimit -f " + std::to_string(blocks) + "; exec \"$0\" \"$@\"",
                                        MESOCELL_COMMAND};
      words.insert(words.end(), job.begin(), job.end());
      // What the command says is written to a file, too.
      RunOptions options;
      options.stdout_path = "/dev/null";
      options.terminal = true;
      const Run run = run_program("/bin/sh", words, options);
      INFO(blocks << " blocks; exit " << run.exit << ": " << run.err);
      CHECK(folder.list() == files);
      const bool fits = wanted.size() <= blocks * kBlock;
      CHECK(run.exit == (fits ? 0 : 4));
      CHECK((read_bytes(output) == (fits ? wanted : kOld)));
      if (!fits) CHECK(run.err.find(output) != std::string::npos);
      refused += !fits;
    }
    CHECK(refused > 0);
    ::unlink(output.c_str());
  }
}
