#include <algorithm>
#include <csignal>
#include <string>
#include <vector>

#include "tests/cli/picture_scene.h"
#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// A benchmark that takes a second or so.
Run bench(const std::vector<std::string>& more) {
  std::vector<std::string> words = {"bench", "--size", "64x48", "--repeat", "1", "--oracle", "100"};
  words.insert(words.end(), more.begin(), more.end());
  return run_command(words);
}

}  // namespace

TEST_CASE("a small benchmark writes CSV, JSON and a table") {
  const TempFolder folder;
  const std::string csv = folder.file("a.csv");
  const std::vector<std::string> words = {"--scenes",  "torus-voronoi-8x8", "--cameras", "full,inside",
                                          "--rays",    "primary,shadow",    "--csv",     csv,
                                          "--methods", "exact,linear:1/16", "--threads", "1,2"};
  std::vector<std::string> json_words = words;
  json_words.emplace_back("--json");
  const Run run = bench(json_words);
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.err.empty());
  CHECK(folder.list() == std::vector<std::string>{"a.csv"});
  const auto report = run.json();
  CHECK(report["exact_differs"] == 0);
  CHECK(report["head"]["size"] == "64x48");
  REQUIRE(report["rows"].size() == 2 * 2 * 2 * 2);
  CHECK(report["rows"][0]["method"] == "exact");
  CHECK(report["rows"][0]["ray_count"] == 64 * 48);
  CHECK(report["rows"][0]["miss_rate"] == 0);
  CHECK(report["rows"][1]["rays_per_second"] > 0);
  const std::string text = read_bytes(csv);
  const std::size_t names = text.find("\nscene,shape,tile,");
  REQUIRE(names != text.npos);
  CHECK(text.starts_with("# program: mesocell bench "));
  const std::ptrdiff_t head = std::count(text.begin(), text.begin() + std::ptrdiff_t(names) + 1, '\n');
  CHECK(std::ranges::count(text, '\n') == head + 1 + 16);
  for (const char* line : {"\n# date: ", "\n# processor: ", "\n# cores: ", "\n# memory: ", "\n# compiler: ",
                           "\n# threads: 1, 2\n", "\n# seed: 1\n", "\n# exact differs: for 0 rays\n"})
    CHECK(text.find(line) < names);

  const Run table = bench(words);
  CHECK(table.exit == 0);
  CHECK(table.out.find("torus-voronoi-8x8, camera inside, shadow rays") != std::string::npos);
  CHECK(table.out.find("| linear:1/16 | 2 |") != std::string::npos);
}

TEST_CASE("a file of the user's is measured") {
  const Scene scene;
  const Run run = bench({"--input", scene.asset, "--cameras", "full", "--rays", "primary", "--methods",
                         "exact", "--json", "--quiet"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  REQUIRE(run.json()["rows"].size() == 1);
  CHECK(run.json()["rows"][0]["scene"] == "ball.meso");
  CHECK(run.json()["rows"][0]["tiles"] == 8);
  const Run missing = bench({"--input", scene.folder.file("none.meso")});
  CHECK(missing.exit == 3);
  CHECK(missing.messages() == 1);
}

TEST_CASE("a set leaves out what there is no time for, and says so") {
  const Run run =
      bench({"--set", "quick", "--scenes", "torus-voronoi-8x8", "--max-seconds", "0.01", "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.json()["rows"].size() > 0);
  CHECK(run.json()["notes"].dump().find("the time was up") != std::string::npos);
}

TEST_CASE("mistakes on the command line of bench end with 2 and say what to do") {
  const TempFolder folder;
  for (const auto& [words, hint] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--set", "huge"}, "quick"},
           {{"--scenes", "cube-voronoi-8x8"}, "wavy"},
           {{"--scenes", ","}, "--help"},
           {{"--cameras", "above"}, "grazing"},
           {{"--rays", "caustic"}, "diffuse"},
           {{"--methods", "guess"}, "embree-instanced"},
           {{"--methods", "linear:2"}, "linear:1/512"},
           {{"--threads", "1,many"}, "number"},
           {{"--threads", ""}, "number"},
           {{"--size", "0x10"}, "1024x768"},
           {{"--repeat", "0"}, "--help"},
           {{"--oracle", "0"}, "--help"},
           {{"--seed", "-1"}, "--help"},
           {{"--max-seconds", "0"}, "--help"},
           {{"--input", "a.meso", "--scenes", "torus-voronoi-8x8"}, "--input"}}) {
    std::vector<std::string> all{"bench"};
    all.insert(all.end(), words.begin(), words.end());
    const Run run = run_command(all);
    INFO(run.err);
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
    CHECK(run.err.find(hint) != std::string::npos);
  }
  CHECK(run_command({"bench", "--csv", "/nowhere/a.csv"}).exit == 4);
  const std::string there = folder.write("there.csv", "x");
  CHECK(run_command({"bench", "--csv", there, "--no-clobber"}).exit == 4);
  CHECK(read_bytes(there) == "x");
}

TEST_CASE("an interrupted benchmark ends with 130 and leaves nothing") {
  for (const int after : {400, 2000}) {
    const TempFolder folder;
    RunOptions options;
    options.signal = SIGINT;
    options.signal_after = std::chrono::milliseconds(after);
    const Run run = run_command({"bench", "--set", "full", "--csv", folder.file("a.csv")}, options);
    CHECK(run.exit == 130);
    CHECK(run.messages() == 1);
    CHECK(folder.list().empty());
  }
}
