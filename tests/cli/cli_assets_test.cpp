#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

/// Two assets, a ball and a box, of one tile.
struct Two {
  TempFolder folder;
  std::string ball = folder.file("ball.meso"), box = folder.file("box.meso"), both = folder.file("both.meso");
  Two() {
    make(ball, make_sphere({0, 0, 0}, 1, 16), {"--meta", "author=Ada", "--meta", "licence=CC0 = free"});
    make(box, make_box({0, 0, 0}, {1, 2, 1}), {});
  }
  void make(const std::string& to, const TriangleMesh& mesh, std::vector<std::string> more) const {
    const std::string file =
        folder.write(std::filesystem::path(to).stem().string() + ".obj", mesh_bytes(mesh, "mesh.obj"));
    std::vector<std::string> words = {
        "convert", file, to, "--tiles", "5", "--tile", "voronoi:cells=4,resolution=8,seed=2"};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_command(words).exit == 0);
  }
};

json info(const std::string& path) {
  const Run run = run_command({"info", path, "--json"});
  CAPTURE(run.err);
  REQUIRE(run.exit == 0);
  return run.json();
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Whether an asset is described in the same words but for codec and place in a file.
bool same_asset(json a, json b) {
  for (json* one : {&a, &b})
    for (const char* key : {"name", "chunks", "assets", "file_bytes", "format", "metadata"}) one->erase(key);
  return a == b;
}

}  // namespace

TEST_CASE("several assets are put into a file, named, told and taken out again") {
  const Two two;
  REQUIRE(run_command({"convert", two.ball, two.box, two.both}).exit == 0);
  const json both = info(two.both);
  REQUIRE(both["assets"].size() == 2);
  CHECK(both["assets"][0]["name"] == "ball");
  CHECK(both["assets"][1]["name"] == "box");
  CHECK(same_asset(both, info(two.ball)));
  CHECK(same_asset(both["assets"][0], info(two.ball)));
  CHECK(same_asset(both["assets"][1], info(two.box)));
  CHECK(run_command({"validate", two.both, "--strict"}).exit == 0);
  const std::string text = run_command({"info", two.both}).out;
  CHECK(text.find("name            ball\n") != std::string::npos);
  CHECK(text.find("name            box\n") != std::string::npos);

  // One of them, by name and by number; put together in another order; a name that is taken gets a number.
  CHECK(same_asset(info(two.both + "#box"), info(two.box)));
  CHECK(same_asset(info(two.both + "#0"), info(two.ball)));
  const std::string out = two.folder.file("out.meso");
  REQUIRE(run_command({"convert", two.both + "#box", out}).exit == 0);
  CHECK(run_command({"compare", out, two.box}).exit == 0);
  REQUIRE(run_command({"convert", two.both + "#1", two.both, out}).exit == 0);
  const json three = info(out);
  REQUIRE(three["assets"].size() == 3);
  CHECK(three["assets"][0]["name"] == "box");
  CHECK(three["assets"][1]["name"] == "ball");
  CHECK(three["assets"][2]["name"] == "box-2");
  CHECK(run_command({"compare", two.both, two.both}).exit == 0);
  CHECK(run_command({"compare", two.both, out}).exit == 1);
  CHECK(run_command({"compare", two.both + "#ball", two.ball}).exit == 0);
  CHECK(run_command({"compare", two.both + "#ball", two.box}).exit == 1);

  // All that reads an asset takes one of several.
  CHECK(run_command({"render", two.both + "#box", two.folder.file("box.png"), "--size", "20x20"}).exit == 0);
  CHECK(run_command({"convert", two.folder.file("ball.obj"), out, "--tile", two.both + "#box"}).exit == 0);
  CHECK(info(out)["cells"] == info(two.box)["cells"]);
}

TEST_CASE("metadata comes in by --meta and stays through a rewriting") {
  const Two two;
  CHECK(info(two.ball)["metadata"]["author"] == "Ada");
  CHECK(info(two.ball)["metadata"]["licence"] == "CC0 = free");
  const std::string out = two.folder.file("out.meso");
  REQUIRE(run_command({"convert", two.ball, out, "--meta", "author=Bo", "--meta", "year=2026"}).exit == 0);
  const json text = info(out)["metadata"];
  CHECK(text["author"] == "Bo");
  CHECK(text["year"] == "2026");
  CHECK(text["licence"] == "CC0 = free");
  CHECK(text["tile"] == info(two.ball)["metadata"]["tile"]);
  for (const char* wrong : {"noequals", "=x", "k=\xff"}) {
    CAPTURE(wrong);
    const Run run = run_command({"convert", two.ball, out, "--meta", wrong});
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
  }
  CHECK(run_command({"convert", two.folder.file("ball.obj"), out, "--meta", "tile=mine"}).exit == 2);
}

TEST_CASE("raw files hold what compressed ones do, and rewriting gives the bytes that writing gave") {
  const Two two;
  const std::string raw = two.folder.file("raw.meso"), back = two.folder.file("back.meso");
  REQUIRE(run_command({"convert", two.ball, raw, "--codec", "raw"}).exit == 0);
  for (const json& chunk : info(raw)["chunks"]) {
    CHECK(chunk["codec"] == "raw");
    CHECK(chunk["stored"] >= chunk["bytes"]);
  }
  CHECK(run_command({"compare", raw, two.ball}).exit == 0);
  REQUIRE(run_command({"convert", raw, back, "--target-version", "1.0"}).exit == 0);
  CHECK(bytes_of(back) == bytes_of(two.ball));
  CHECK(run_command({"convert", raw, back, "--codec", "gzip"}).exit == 2);
  for (const char* version : {"0.9", "1.2", "2", ""})
    CHECK(run_command({"convert", raw, back, "--target-version", version}).exit == 2);
  const Run unused = run_command({"convert", raw, back, "--tiles", "3"});
  CHECK(unused.exit == 0);
  CHECK(unused.messages() >= 1);
}

TEST_CASE("what cannot be put together is refused, and nothing is written") {
  const Two two;
  const std::string out = two.folder.file("out.meso");
  CHECK(run_command({"convert", two.both, out}).exit == 3);  // is not there yet
  REQUIRE(run_command({"convert", two.ball, two.box, two.both}).exit == 0);
  CHECK(run_command({"convert", two.both + "#cone", out}).exit == 2);
  CHECK(run_command({"convert", two.both + "#2", out}).exit == 2);
  CHECK(run_command({"render", two.both + "#cone", two.folder.file("x.png")}).exit == 2);
  CHECK(run_command({"info", two.both + "#cone"}).err.find("ball, box") != std::string::npos);
  CHECK(run_command({"convert", two.folder.file("ball.obj"), two.folder.file("box.obj"), out}).exit == 2);
  CHECK(run_command({"convert", two.ball, two.folder.file("box.obj"), out}).exit == 2);
  CHECK(run_command({"convert", two.both + "#ball", two.both}).exit == 2);
  CHECK(run_command({"convert", two.both}).exit == 2);
  CHECK(run_command({"convert", two.ball, two.both, "--no-clobber"}).exit == 4);
  const std::string damaged = two.folder.write("damaged.meso", [&] {
    std::string bytes = bytes_of(two.both);
    bytes[bytes.size() - 100] = char(bytes[bytes.size() - 100] ^ 1);
    return bytes;
  }());
  CHECK(run_command({"convert", damaged, out}).exit == 3);
  CHECK(run_command({"validate", damaged}).exit == 1);
  CHECK_FALSE(std::filesystem::exists(out));
  // What is whole of it can be saved.
  CHECK(run_command({"convert", damaged + "#ball", out}).exit == 0);
  CHECK(run_command({"compare", out, two.ball}).exit == 0);
}

TEST_CASE("the tags of one tile are told from a part of the file") {
  const Two two;
  REQUIRE(run_command({"convert", two.ball, two.box, two.both}).exit == 0);
  const Run run = run_command({"info", two.both + "#ball", "--tile", "2,2,2", "--json"});
  REQUIRE(run.exit == 0);
  CHECK(run.json()["tile"] == json({2, 2, 2}));
  CHECK(run.json()["tags"] == json({"inside", "inside", "inside", "inside"}));
  CHECK(run.json()["file_bytes"] == std::filesystem::file_size(two.both));
  CHECK(run.json()["bytes_read"] > 64);
  for (const char* wrong : {"2,2", "5,0,0", "-1,0,0", "0.5,0,0", "x", "nan,0,0"}) {
    CAPTURE(wrong);
    CHECK(run_command({"info", two.ball, "--tile", wrong}).exit == 2);
  }
  CHECK(run_command({"info", two.folder.file("none.meso"), "--tile", "0,0,0"}).exit == 3);
  CHECK(run_command({"info", two.folder.file("ball.obj"), "--tile", "0,0,0"}).exit == 3);
}

TEST_CASE("a warning counts as a fault where that is asked for") {
  const Two two;
  // A ball of few tiles has no whole cell inside.
  const std::string out = two.folder.file("nothing.meso");
  REQUIRE(run_command({"convert", two.folder.file("ball.obj"), out, "--tiles", "1", "--tile",
                       "voronoi:cells=1,resolution=8,seed=2"})
              .exit == 0);
  const Run plain = run_command({"validate", out, "--json"});
  CHECK(plain.exit == 0);
  CHECK(plain.json()["valid"] == true);
  CHECK(plain.json()["warnings"] == 1);
  CHECK(plain.json()["errors"] == 0);
  CHECK(plain.json()["issues"][0]["id"] == "memb-nothing-inside");
  const Run strict = run_command({"validate", out, "--json", "--strict"});
  CHECK(strict.exit == 1);
  CHECK(strict.json()["valid"] == false);
  CHECK(run_command({"validate", two.ball, "--strict"}).exit == 0);
}

TEST_CASE("a report is as its published schema says") {
  std::ifstream in(std::string(MESOCELL_SPEC_FOLDER) + "/validation-report.schema.json");
  const json schema = json::parse(in, nullptr, false);
  REQUIRE(schema.is_object());
  // As much of JSON Schema as this one uses.
  const std::function<bool(const json&, const json&)> fits = [&](const json& rule, const json& value) {
    if (rule.contains("enum") &&
        std::find(rule["enum"].begin(), rule["enum"].end(), value) == rule["enum"].end())
      return false;
    if (rule.contains("type")) {
      const json types = rule["type"].is_array() ? rule["type"] : json::array({rule["type"]});
      const std::string own = value.is_number_integer() ? "integer" : value.type_name();
      if (std::find(types.begin(), types.end(), own) == types.end()) return false;
    }
    if (rule.contains("minimum") && value.is_number() && value < rule["minimum"]) return false;
    if (rule.contains("minLength") && value.is_string() &&
        value.get<std::string>().size() < rule["minLength"])
      return false;
    const json required = rule.value("required", json::array()),
               properties = rule.value("properties", json::object());
    for (const json& key : required)
      if (!value.contains(key.get<std::string>())) return false;
    for (const auto& [key, of] : properties.items())
      if (value.contains(key) && !fits(of, value[key])) return false;
    if (rule.contains("items"))
      for (const json& item : value)
        if (!fits(rule["items"], item)) return false;
    return true;
  };
  const Two two;
  const std::string whole = bytes_of(two.ball);
  std::vector<std::string> files = {whole, whole.substr(0, 100), whole.substr(0, whole.size() / 2),
                                    whole + "x"};
  for (std::size_t at = 8; at < whole.size(); at += 97) {
    files.push_back(whole);
    files.back()[at] = char(files.back()[at] ^ 0x10);
  }
  for (const std::string& bytes : files) {
    const json report = run_command({"validate", two.folder.write("x.meso", bytes), "--json"}).json();
    CHECK(fits(schema, report));
    for (const auto& [key, value] : report.items()) CHECK(schema["properties"].contains(key));
    for (const json& issue : report["issues"])
      for (const auto& [key, value] : issue.items())
        CHECK(schema["properties"]["issues"]["items"]["properties"].contains(key));
  }
}
