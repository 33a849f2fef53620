#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

TEST_CASE("every subcommand has a help text with an example") {
  const Run all = run_command({"--help"});
  CHECK(all.exit == 0);
  CHECK(all.err.empty());
  CHECK(all.out.find("130") != std::string::npos);
  for (const std::string name : {"convert", "info", "validate", "render", "compare", "stability", "bench"}) {
    CHECK(all.out.find("  " + name) != std::string::npos);
    const Run run = run_command({name, "--help"});
    INFO(name);
    CHECK(run.exit == 0);
    CHECK(run.err.empty());
    CHECK(run.out.find("Example:") != std::string::npos);
    CHECK(run.out.find("mesocell " + name) != std::string::npos);
    for (const char* option : {"--json", "--quiet", "--threads"})
      CHECK(run.out.find(option) != std::string::npos);
  }
  CHECK(run_command({"convert", "--help"}).out.find("spheres") != std::string::npos);
  CHECK(run_command({"convert", "--help"}).out.find("marble") != std::string::npos);
}

TEST_CASE("the versions of library and format are told") {
  const Run run = run_command({"--version"});
  CHECK(run.exit == 0);
  CHECK(run.out == "mesocell 0.12.0, format meso 1.1\n");
}

TEST_CASE("wrong usage ends with 2 and one message") {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{},
                                             {"frobnicate"},
                                             {"convert"},
                                             {"convert", "a.obj"},
                                             {"convert", "a.obj", "b.meso", "c.meso"},
                                             {"convert", "a.obj", "b.ply"},
                                             {"convert", "a.meso", "b.xyz"},
                                             {"convert", "a.obj", "b.meso", "--tiles"},
                                             {"info"},
                                             {"info", "a.meso", "b.meso"},
                                             {"info", "a.meso", "--tiles", "3"},
                                             {"validate", "--bogus"},
                                             {"render", "a.meso"},
                                             {"render", "a.meso", "b.png", "--threads", "x"},
                                             {"compare", "a.meso"},
                                             {"compare", "a.meso", "b.png"},
                                             {"compare", "a.png", "b.meso"},
                                             {"compare", "a.bmp", "b.bmp"},
                                             {"compare", "a.png", "b.png", "c.png"},
                                             {"compare", "a.png", "b.off"},
                                             {"compare", "a.off", "b.off"},
                                             {"compare", "a.off", "b.meso"},
                                             {"compare", "a.meso", "b.off", "--tolerance", "-1"},
                                             {"compare", "a.meso", "b.off", "--tolerance", "inf"},
                                             {"compare", "a.meso", "b.off", "--samples", "0"},
                                             {"compare", "a.meso", "b.off", "--samples", "1000000001"},
                                             {"compare", "a.meso", "b.off", "--seed", "-1"},
                                             {"compare", "a.png", "b.png", "--tolerance", "-0.1"},
                                             {"compare", "a.png", "b.png", "--tolerance", "1.5"},
                                             {"compare", "a.png", "b.png", "--tolerance", "nan"},
                                             {"--bogus"}}) {
    const Run run = run_command(words);
    INFO((words.empty() ? "" : words.back()) << ": " << run.err);
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
    CHECK(run.err.starts_with("mesocell: "));
    CHECK(run.out.empty());
  }
}

TEST_CASE("input and output may not be the same file") {
  const TempFolder folder;
  const std::string bytes = mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.off");
  const std::string mesh = folder.write("box.off", bytes);
  REQUIRE(run_command({"convert", mesh, folder.file("box.meso"), "--tiles", "2"}).exit == 0);
  CHECK(run_program("/bin/ln", {"-s", "box.off", folder.file("link.meso")}).exit == 0);
  CHECK(run_command({"convert", mesh, folder.file("link.meso")}).exit == 2);
  CHECK(run_command({"convert", mesh, mesh}).exit == 2);
  CHECK(run_program("/bin/ln", {"-s", "box.meso", folder.file("link.png")}).exit == 0);
  CHECK(run_command({"render", folder.file("box.meso"), folder.file("link.png")}).exit == 2);
  CHECK(read_bytes(mesh) == bytes);
}

TEST_CASE("a closed pipe is no crash, a full disk is an error") {
  const TempFolder folder;
  const std::string mesh = folder.write("box.off", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.off"));
  REQUIRE(run_command({"convert", mesh, folder.file("box.meso"), "--tiles", "2"}).exit == 0);
  RunOptions closed;
  closed.closed_stdout = true;
  const Run piped = run_command({"info", folder.file("box.meso"), "--json"}, closed);
  CHECK(piped.exit == 0);
  CHECK(piped.err.empty());
  RunOptions full;
  full.stdout_path = "/dev/full";
  const Run run = run_command({"info", folder.file("box.meso"), "--json"}, full);
  CHECK(run.exit == 4);
  CHECK(run.messages() == 1);
}
