#include <cstdlib>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

const std::string kTable =
    "# program: mesocell bench\n"
    "scene,camera,rays,method,threads,rays_per_second,peak_bytes,miss_rate,depth_error_max,hit_rate,"
    "false_hit_rate,wrong_cell_rate,steps_per_ray,angle_degrees\n"
    "wavy,full,primary,exact,2,1.5e7,6e6,0,0,0.58,0,0,20,40\n"
    "wavy,grazing,primary,exact,2,1.1e7,6e6,0,0,0.58,0,0,45,5\n"
    "wavy,full,primary,linear:1/128,2,9e5,5e6,0.002,30,0.58,0,0.003,170,40\n"
    "wavy,grazing,primary,linear:1/128,2,4e5,5e6,0.02,90,0.58,0,0.01,900,5\n"
    "wavy,full,primary,\"odd'`name`\",1,4e5,5e6,0.02,90,0.58,0,0.01,,\n";

bool have_gnuplot() { return std::system("command -v gnuplot >/dev/null 2>&1") == 0; }

}  // namespace

TEST_CASE("a benchmark's figures become an SVG and a PNG") {
  if (!have_gnuplot()) {
    WARN("gnuplot is not there: skipped");
    return;
  }
  const TempFolder folder;
  const std::string in = folder.write("in.csv", kTable);
  const Run svg = run_command({"chart", in, folder.file("out.svg")});
  INFO(svg.err);
  REQUIRE(svg.exit == 0);
  CHECK(svg.out.empty());
  CHECK(svg.err.empty());
  const std::string text = read_bytes(folder.file("out.svg"));
  CHECK(text.find("<svg") != std::string::npos);
  CHECK(text.ends_with("</svg>\n\n"));
  for (const char* part : {"exact", "linear:1/128", "Speed against error", "Memory against error",
                           "Steps against angle", "rays with a wrong answer", "none"})
    CHECK(text.find(part) != std::string::npos);
  // The same rows give the same picture.
  REQUIRE(run_command({"chart", in, folder.file("again.svg")}).exit == 0);
  CHECK(read_bytes(folder.file("again.svg")) == text);

  const Run png =
      run_command({"chart", in, folder.file("out.png"), "--threads", "1", "--chart", "pareto", "--json"});
  INFO(png.err);
  REQUIRE(png.exit == 0);
  CHECK(read_bytes(folder.file("out.png")).starts_with("\x89PNG\r\n\x1a\n"));
  REQUIRE(png.json()["methods"].size() == 1);
  CHECK(png.json()["methods"][0]["method"] == "odd'`name`");
  CHECK(folder.list() == std::vector<std::string>{"again.svg", "in.csv", "out.png", "out.svg"});
}

TEST_CASE("each chart can be had alone") {
  if (!have_gnuplot()) return;
  const TempFolder folder;
  const std::string in = folder.write("in.csv", kTable), out = folder.file("out.svg");
  const std::vector<std::string> titles = {"Speed against error", "Memory against error",
                                           "Steps against angle"};
  const std::vector<std::string> names = {"pareto", "memory", "steps"};
  for (std::size_t k = 0; k < names.size(); ++k) {
    CAPTURE(names[k]);
    REQUIRE(run_command({"chart", in, out, "--chart", names[k], "--error", "depth"}).exit == 0);
    const std::string text = read_bytes(out);
    for (std::size_t j = 0; j < titles.size(); ++j)
      CHECK((text.find(titles[j]) != std::string::npos) == (j == k));
  }
  const Run kept = run_command({"chart", in, out, "--no-clobber"});
  CHECK(kept.exit == 4);
}

TEST_CASE("tables that are none give exit 3 and no picture") {
  const TempFolder folder;
  const std::string out = folder.file("out.svg");
  const std::string names =
      kTable.substr(kTable.find("scene"), kTable.find("\nwavy") - kTable.find("scene") + 1);
  for (const std::string& bad : {std::string(), std::string("# nothing\n"), names, std::string("a,b\n1,2\n"),
                                 names + "wavy,full,primary,exact,2,nan,6e6,0,0,0.58,0,0,20,40\n",
                                 names + "wavy,full,primary,exact,2,1e7,6e6,0,0,0.58,0,0\n",
                                 std::string(20000000, ','), std::string("\x89PNG\r\n\x1a\n\0\0\0", 11)}) {
    CAPTURE(bad.substr(0, 200));
    const Run run = run_command({"chart", folder.write("bad.csv", bad), out});
    CHECK(run.exit == 3);
    CHECK(run.messages() == 1);
    CHECK(folder.list() == std::vector<std::string>{"bad.csv"});
  }
  CHECK(run_command({"chart", folder.file("absent.csv"), out}).exit == 3);
}

TEST_CASE("words that mean nothing to chart give exit 2") {
  const TempFolder folder;
  const std::string in = folder.write("in.csv", kTable), out = folder.file("out.svg");
  const std::vector<std::vector<std::string>> cases = {{in},
                                                       {in, folder.file("out.pdf")},
                                                       {in, out, "--chart", "pie"},
                                                       {in, out, "--error", "small"},
                                                       {in, out, "--scene", "absent"},
                                                       {in, out, "--threads", "3"},
                                                       {in, out, "--threads", "x"}};
  for (std::vector<std::string> words : cases) {
    words.insert(words.begin(), "chart");
    const Run run = run_command(words);
    CAPTURE(words, run.err);
    CHECK(run.exit == 2);
  }
  const std::string same = folder.write("same.svg", kTable);
  CHECK(run_command({"chart", same, same}).exit == 2);
}

TEST_CASE("where gnuplot is not there its package is named") {
  const TempFolder folder;
  RunOptions options;
  options.environment = {"PATH=" + folder.file("")};
  const Run run = run_command({"chart", folder.write("in.csv", kTable), folder.file("out.svg")}, options);
  CHECK(run.exit == 4);
  CHECK(run.err.find("gnuplot-nox") != std::string::npos);
  CHECK(folder.list() == std::vector<std::string>{"in.csv"});
}
