#include <csignal>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

TEST_CASE("a small catalogue gives a table, a picture and all figures") {
  const TempFolder folder;
  const Run run =
      run_command({"stability", "--voxelize", "--resolution", "16", "--cases", "clean,planes,holes 1 %",
                   "--methods", "parity-x,ours", "--csv", folder.file("t.csv"), "--markdown",
                   folder.file("t.md"), "--picture", folder.file("t.svg"), "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(folder.list() == std::vector<std::string>{"t.csv", "t.md", "t.svg"});
  const auto report = run.json();
  CHECK(report["methods"].size() == 2);
  REQUIRE(report["cases"].size() == 4);
  CHECK(report["cases"][0]["case"] == "clean");
  CHECK(report["cases"][0]["results"]["ours"]["wrong"] == 0);
  CHECK(report["cases"][0]["results"]["ours"]["inside"] > 100);
  CHECK(report["cases"][1]["case"] == "holes 1 %");
  CHECK(report["cases"][1]["results"]["parity-x"]["outcome"] == "done");
  const std::string csv = read_bytes(folder.file("t.csv"));
  CHECK(std::ranges::count(csv, '\n') == 1 + 2 * (3 + 3 + 2));
  CHECK(read_bytes(folder.file("t.svg")).starts_with("<svg "));
  CHECK(read_bytes(folder.file("t.md")).find("| holes 1 % |") != std::string::npos);
}

TEST_CASE("a mesh and a pair of one's own are measured") {
  const TempFolder folder;
  const TriangleMesh sound = make_torus({0, 0, 0}, 1, 0.5, 20, 12);
  TriangleMesh broken = sound;
  broken.triangles.resize(broken.triangles.size() - 6);
  const std::string a = folder.write("broken.off", mesh_bytes(broken, "mesh.off")),
                    b = folder.write("sound.off", mesh_bytes(sound, "mesh.off"));
  const Run pair = run_command({"stability", "--voxelize", "--resolution", "16", "--pair", a, b, "--cases",
                                "pair", "--methods", "signed-count,ours", "--json"});
  INFO(pair.err);
  REQUIRE(pair.exit == 0);
  REQUIRE(pair.json()["cases"].size() == 1);
  CHECK(pair.json()["cases"][0]["case"] == "broken");
  CHECK(pair.json()["cases"][0]["results"]["signed-count"]["wrong"] > 0);

  const Run benchmark =
      run_command({"stability", "--voxelize", "--benchmark", "--mesh", b, "--sizes", "24,32", "--json"});
  INFO(benchmark.err);
  REQUIRE(benchmark.exit == 0);
  const auto results = benchmark.json()["results"];
  REQUIRE(results.size() == 2 * 2 * 3);
  for (const auto& result : results) {
    CHECK(result["outcome"] == "done");
    // So small a run may fit into pages that are there.
    CHECK(result["memory_bytes"] >= 0);
    if (result["method"] == "ours" && result["case"] == "clean") CHECK(result["wrong"] == 0);
  }

  const Run open = run_command({"stability", "--voxelize", "--mesh", a});
  CHECK(open.exit == 3);
  CHECK(open.err.find("--pair") != std::string::npos);
  CHECK(run_command({"stability", "--voxelize", "--pair", b, a}).exit == 3);
}

TEST_CASE("a small catalogue of casting gives verdicts, tables and a picture") {
  const TempFolder folder;
  const Run run = run_command({"stability", "--cast", "--rays", "100", "--cases", "wall,light", "--methods",
                               "exact,linear:1/128", "--csv", folder.file("t.csv"), "--markdown",
                               folder.file("t.md"), "--picture", folder.file("t.svg"), "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(folder.list() == std::vector<std::string>{"t.csv", "t.md", "t.svg"});
  const auto report = run.json();
  CHECK(report["kind"] == "cast");
  CHECK(report["holds"] == true);
  CHECK(report["methods"] == std::vector<std::string>{"exact", "linear:1/128"});
  REQUIRE(report["cases"].size() == 3 + 4 + 3);
  const auto wall = report["cases"][0];
  CHECK(wall["case"] == "wall 1 voxel");
  CHECK(wall["results"]["exact"]["verdict"] == "holds");
  CHECK(wall["results"]["exact"]["rays"] == 100);
  CHECK(wall["results"]["linear:1/128"]["verdict"] == "fails as the source predicts");
  CHECK(wall["results"]["linear:1/128"]["missed"] > 5);
  CHECK(std::ranges::count(read_bytes(folder.file("t.csv")), '\n') == 1 + 2 * 10);
  CHECK(read_bytes(folder.file("t.svg")).starts_with("<svg "));
  CHECK(read_bytes(folder.file("t.md")).find("| wall 1 voxel | holds |") != std::string::npos);
  // The same on any number of threads.
  const Run again = run_command({"stability", "--cast", "--rays", "100", "--cases", "wall,light", "--methods",
                                 "exact,linear:1/128", "--json", "--threads", "1"});
  CHECK(again.out == run.out);
}

TEST_CASE("mistakes on the command line of stability end with 2 and say what to do") {
  const TempFolder folder;
  for (const auto& [words, hint] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "--voxelize"},
           {{"--voxelize", "--methods", "guess"}, "winding-exact"},
           {{"--voxelize", "--cases", "earthquake"}, "holes"},
           {{"--voxelize", "--picture", folder.file("a.jpg")}, ".svg"},
           {{"--voxelize", "--resolution", "3"}, "--help"},
           {{"--voxelize", "--sizes", "64"}, "--benchmark"},
           {{"--voxelize", "--benchmark", "--sizes", "64,many"}, "number"},
           {{"--voxelize", "--benchmark", "--resolution", "64"}, "--sizes"},
           {{"--voxelize", "--pair", "a.off"}, "two files"},
           {{"--voxelize", "--cast"}, "--cast"},
           {{"--voxelize", "--rays", "100"}, "--cast"},
           {{"--cast", "--methods", "guess"}, "linear:1/512"},
           {{"--cast", "--cases", "earthquake"}, "needle"},
           {{"--cast", "--rays", "3"}, "--help"},
           {{"--cast", "--resolution", "32"}, "--voxelize"},
           {{"--cast", "--benchmark"}, "--voxelize"},
           {{"--cast", "--picture", folder.file("a.png")}, ".svg"}}) {
    std::vector<std::string> all{"stability"};
    all.insert(all.end(), words.begin(), words.end());
    const Run run = run_command(all);
    INFO(run.err);
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
    CHECK(run.err.find(hint) != std::string::npos);
  }
  CHECK(run_command({"stability", "--voxelize", "--csv", "/nowhere/a.csv"}).exit == 4);
  CHECK(run_command({"stability", "--cast", "--csv", "/nowhere/a.csv"}).exit == 4);
  CHECK(folder.list().empty());
}

TEST_CASE("an interrupted catalogue ends with 130") {
  const TempFolder folder;
  RunOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(500);
  const Run run =
      run_command({"stability", "--voxelize", "--resolution", "200", "--csv", folder.file("a.csv")}, options);
  CHECK(run.exit == 130);
  CHECK(run.messages() == 1);
  CHECK(folder.list().empty());
}

TEST_CASE("an interrupted catalogue of casting ends with 130") {
  const TempFolder folder;
  RunOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(500);
  const Run run =
      run_command({"stability", "--cast", "--rays", "20000", "--csv", folder.file("a.csv")}, options);
  CHECK(run.exit == 130);
  CHECK(folder.list().empty());
}
