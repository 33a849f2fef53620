#include <pty.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using std::chrono::milliseconds;

namespace {

/// A conversion that takes far longer than these tests wait.
std::vector<std::string> long_convert(const TempFolder& folder) {
  const TriangleMesh torus = make_torus({0, 0, 0}, 1, 0.5, 400, 200);
  return {"convert",
          folder.write("torus.off", mesh_bytes(torus, "mesh.off")),
          folder.file("torus.meso"),
          "--tiles",
          "128",
          "--tile",
          "voronoi:cells=100,resolution=256,seed=1"};
}

}  // namespace

TEST_CASE("an interrupted conversion ends with 130 and leaves nothing") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    for (const int after : {800, 1500}) {
      const TempFolder folder;
      RunOptions options;
      options.signal = signal;
      options.signal_after = milliseconds(after);
      const Run run = run_command(long_convert(folder), options);
      INFO("signal " << signal << " after " << after << " ms: " << run.err);
      CHECK(run.exit == 130);
      CHECK(run.messages() == 1);
      CHECK(folder.list() == std::vector<std::string>{"torus.off"});
    }
}

TEST_CASE("an interrupted conversion leaves the old output whole") {
  const TempFolder folder;
  folder.write("torus.meso", "the old file");
  RunOptions options;
  options.signal = SIGINT;
  options.signal_after = milliseconds(500);
  CHECK(run_command(long_convert(folder), options).exit == 130);
  CHECK(read_bytes(folder.file("torus.meso")) == "the old file");
  CHECK(folder.list() == std::vector<std::string>{"torus.meso", "torus.off"});
}

TEST_CASE("an interrupted rendering ends with 130, leaves nothing and the old output whole") {
  const TempFolder folder;
  const std::string input = folder.write("box.off", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.off"));
  REQUIRE(run_command({"convert", input, folder.file("box.meso"), "--tiles", "8"}).exit == 0);
  folder.write("old.png", "the old file");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    for (const char* output : {"new.png", "old.png"}) {
      RunOptions options;
      options.signal = signal;
      options.signal_after = milliseconds(500);
      const Run run = run_command({"render", folder.file("box.meso"), folder.file(output), "--size",
                                   "4096x4096", "--method", "linear:1/100000"},
                                  options);
      INFO("signal " << signal << ": " << run.err);
      CHECK(run.exit == 130);
      CHECK(run.messages() == 1);
      CHECK(read_bytes(folder.file("old.png")) == "the old file");
      CHECK(folder.list() == std::vector<std::string>{"box.meso", "box.off", "old.png"});
    }
}

TEST_CASE("a command that is to outlive its terminal does") {
  const TempFolder folder;
  const std::string input = folder.write("box.off", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.off"));
  RunOptions options;
  options.signal = SIGHUP;
  options.signal_after = milliseconds(60);
  const Run run = run_program("/bin/sh",
                              {"-c", "trap '' HUP; exec \"$0\" \"$@\"", MESOCELL_COMMAND, "convert", input,
                               folder.file("box.meso"), "--tiles", "4"},
                              options);
  CHECK(run.exit == 0);
  CHECK(folder.list() == std::vector<std::string>{"box.meso", "box.off"});
}

TEST_CASE("long work shows its progress on a terminal, and nowhere else") {
  int ends[2];
  if (openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0) {
    WARN("this system gives no terminal; skipped");
    return;
  }
  close(ends[0]);
  close(ends[1]);
  const TempFolder folder;
  RunOptions options;
  options.signal = SIGINT;
  options.signal_when = " left";
  options.terminal = true;
  const Run seen = run_command(long_convert(folder), options);
  CHECK(seen.exit == 130);
  CHECK(seen.err.find(" %") != std::string::npos);
  CHECK(seen.err.find("left") != std::string::npos);
  CHECK(seen.err.find("mesocell: ") > seen.err.rfind("left"));
  std::vector<std::string> quiet = long_convert(folder);
  quiet.push_back("--quiet");
  options.signal_when.clear();
  options.signal_after = milliseconds(2000);
  CHECK(run_command(quiet, options).err.find('%') == std::string::npos);
}
