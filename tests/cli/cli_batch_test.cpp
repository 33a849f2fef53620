#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

const std::vector<std::string> kBatchOptions = {"--tiles", "4", "--tile",
                                                "voronoi:cells=4,resolution=8,seed=2"};

Run convert_many(std::vector<std::string> words, const std::vector<std::string>& more = {},
                 const RunOptions& options = {}) {
  words.insert(words.begin(), "convert");
  words.insert(words.end(), kBatchOptions.begin(), kBatchOptions.end());
  words.insert(words.end(), more.begin(), more.end());
  return run_command(words, options);
}

}  // namespace

TEST_CASE("a batch makes every file, and leaves those that are up to date") {
  const TempFolder folder;
  const std::string ball = folder.write("ball.obj", mesh_bytes(make_sphere({0, 0, 0}, 1, 12), "mesh.obj"));
  const std::string box = folder.write("box.ply", mesh_bytes(make_box({0, 0, 0}, {1, 1, 2}), "little.ply"));
  const std::string out = folder.file("out/");
  Run run = convert_many({ball, box, "shape:torus", out}, {"--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.json()["made"] == 3);
  CHECK(run.json()["files"][1]["status"] == "made");
  CHECK(run.json()["files"][1]["report"]["tiles"].size() == 3);
  for (const char* name : {"ball.meso", "box.meso", "shape-torus.meso"}) {
    INFO(name);
    CHECK(std::filesystem::exists(out + name));
  }
  // As if it were made alone.
  REQUIRE(convert_many({ball, folder.file("alone.meso")}).exit == 0);
  CHECK(read_bytes(out + "ball.meso") == read_bytes(folder.file("alone.meso")));

  run = convert_many({ball, box, "shape:torus", out}, {"--json"});
  CHECK(run.json()["up_to_date"] == 3);
  // Another file, an output that went, other options, or force.
  folder.write("ball.obj", mesh_bytes(make_sphere({0, 0, 0}, 2, 12), "mesh.obj"));
  std::filesystem::remove(out + "box.meso");
  run = convert_many({ball, box, "shape:torus", out}, {"--json"});
  CHECK(run.json()["made"] == 2);
  CHECK(run.json()["files"][2]["status"] == "up-to-date");
  run = convert_many({ball, box, "shape:torus", out}, {"--json", "--rule", "conservative"});
  CHECK(run.json()["made"] == 3);
  run = convert_many({ball, box, "shape:torus", out},
                     {"--json", "--rule", "conservative", "--force", "--jobs", "1"});
  CHECK(run.json()["made"] == 3);
}

TEST_CASE("a batch makes again what was made of a file that changed beside its input") {
  const TempFolder folder;
  const PlainPicture red{1, 1, 3, {255, 0, 0}}, blue{1, 1, 3, {0, 0, 255}};
  const std::string texture = folder.write("skin.png", png_bytes(red));
  const std::string mtl = folder.write("ball.mtl", "newmtl m\nmap_Kd skin.png\n");
  const std::string plain = mesh_bytes(make_sphere({0, 0, 0}, 1, 12), "mesh.obj");
  std::string corners = "mtllib ball.mtl\nvt 0 0\nusemtl m\n";
  for (const char c : plain.substr(0, plain.find("f "))) corners += c;
  for (std::size_t at = plain.find("f "); at < plain.size(); at = plain.find('\n', at) + 1) {
    std::istringstream words(plain.substr(at + 2, plain.find('\n', at) - at - 2));
    corners += "f";
    for (std::string word; words >> word;) corners += " " + word.substr(0, word.find('/')) + "/1";
    corners += "\n";
  }
  const std::string ball = folder.write("ball.obj", corners), out = folder.file("out/");
  const auto status = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options = {"--json"};
    options.insert(options.end(), more.begin(), more.end());
    const Run run = convert_many({ball, out}, options);
    INFO(run.err);
    REQUIRE(run.exit == 0);
    return run.json()["files"][0];
  };
  const std::vector<std::string> colored = {"--color", "mesh"};
  json made = status(colored);
  CHECK(made["status"] == "made");
  CHECK(made["report"]["files"] == json{mtl, texture});
  const std::string first = read_bytes(out + "ball.meso");
  CHECK(status(colored)["status"] == "up-to-date");
  folder.write("skin.png", png_bytes(blue));
  CHECK(status(colored)["status"] == "made");
  CHECK(read_bytes(out + "ball.meso") != first);
  CHECK(status(colored)["status"] == "up-to-date");
  folder.write("ball.mtl", "newmtl m\nKd 1 1 0\nmap_Kd skin.png\n");
  CHECK(status(colored)["status"] == "made");
  // One that went costs a warning, once; when it comes again it counts again.
  std::filesystem::remove(texture);
  made = status(colored);
  CHECK(made["status"] == "made");
  CHECK(made["report"]["warnings"][0]["id"] == "texture-missing");
  CHECK(status(colored)["status"] == "up-to-date");
  folder.write("skin.png", png_bytes(red));
  CHECK(status(colored)["status"] == "made");
  // Where no colors are asked for, materials do not matter.
  CHECK(status({})["report"]["files"].empty());
  folder.write("skin.png", png_bytes(blue));
  CHECK(status({})["status"] == "up-to-date");
  // Also the words' own files.
  const std::string own = folder.write("own.png", png_bytes(red));
  const std::vector<std::string> with_own = {"--color", "mesh:texture=" + own};
  CHECK(status(with_own)["report"]["files"] == json{own});
  CHECK(status(with_own)["status"] == "up-to-date");
  folder.write("own.png", png_bytes(blue));
  CHECK(status(with_own)["status"] == "made");
  // A record of a version that knew of no such files.
  const std::string record = out + ".mesocell-batch.json";
  json old = json::parse(read_bytes(record));
  old["made"]["ball.meso"] = old["made"]["ball.meso"]["of"];
  folder.write("out/.mesocell-batch.json", old.dump());
  CHECK(status(with_own)["status"] == "made");
}

TEST_CASE("a conversion tells of all files that it read beside its input") {
  const TempFolder folder;
  const std::string out = folder.file("a.meso");
  const auto files = [&](const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"convert", input, out, "--json", "--tiles", "4"};
    words.insert(words.end(), more.begin(), more.end());
    const Run run = run_command(words);
    INFO(run.err);
    REQUIRE(run.exit == 0);
    return run.json()["files"];
  };
  CHECK(files("shape:sphere").empty());
  const std::string box = folder.write("box.obj", mesh_bytes(make_box({0, 0, 0}, {1, 1, 2}), "mesh.obj"));
  CHECK(files(box, {"--tile", "mesh:resolution=8,file=" + box}) == json{box});
  std::filesystem::create_directory(folder.file("slices"));
  json slices{folder.file("slices/")};
  PlainPicture slice{4, 4, 1, std::vector<std::uint32_t>(16, 1)};
  for (const char* name : {"0.png", "1.png", "2.png", "3.png"}) {
    slice.samples[5] = std::uint32_t(name[0]);
    slices.push_back(folder.write(std::string("slices/") + name, png_bytes(slice)));
  }
  CHECK(files(box, {"--tile", "labels:file=" + folder.file("slices/")}) == slices);
  CHECK(files(box, {"--color", "image:file=" + folder.file("slices/")}) == slices);
  CHECK(files(folder.file("slices/")).size() == 4);
  const std::string tile = folder.file("tile.meso");
  REQUIRE(run_command({"convert", "tile:bricks:resolution=16", tile}).exit == 0);
  CHECK(files(box, {"--tile", tile}) == json{tile});
  CHECK(files(box, {"--tile", tile + "#0"}) == json{tile});
  std::string numbers;
  for (int i = 0; i < 64; ++i) numbers += char(i);
  const std::string raw = folder.write("scan.raw", numbers);
  const std::string head = folder.write("scan.mhd",
                                        "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\n"
                                        "ElementType = MET_UCHAR\nElementDataFile = scan.raw\n");
  CHECK(files(head) == json{raw});
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<std::uint16_t> triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const std::string buffer =
      folder.write("a b.bin", std::string(reinterpret_cast<const char*>(corners.data()), 48) +
                                  std::string(reinterpret_cast<const char*>(triangles.data()), 24));
  CHECK(files(folder.write("a.gltf", R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"indices":1,
    "attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":72,"uri":"a%20b.bin"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
    {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})")) == json{buffer});
}

TEST_CASE("a list names inputs, names that meet are told apart") {
  const TempFolder folder;
  const std::string box = mesh_bytes(make_box({0, 0, 0}, {1, 1, 2}), "mesh.obj");
  folder.write("a.obj", box);
  folder.write("a.ply", mesh_bytes(make_box({0, 0, 0}, {1, 1, 2}), "text.ply"));
  std::filesystem::create_directory(folder.file("b"));
  folder.write("b/a.obj", box);
  const std::string list = folder.write("list.txt", "# meshes\n" + folder.file("a.obj") + "\r\n\n" +
                                                        folder.file("a.ply") + "\n" + folder.file("b/a.obj"));
  const std::string out = folder.file("out/");
  const Run run = convert_many({"@" + list, out});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.out.find("3 made, 0 up to date, 0 failed") != std::string::npos);
  for (const char* name : {"a.obj.meso", "a.ply.meso", "a.obj-2.meso"}) {
    INFO(name);
    CHECK(std::filesystem::exists(out + name));
  }
  const Run assets = run_command(
      {"convert", out + "a.ply.meso", out + "a.obj.meso", folder.file("tiles/"), "--to", "json", "--json"});
  INFO(assets.err);
  CHECK(assets.exit == 0);
  CHECK(std::filesystem::exists(folder.file("tiles/a.ply.json")));
}

TEST_CASE("a file that fails ends a batch, or costs itself alone") {
  const TempFolder folder;
  const std::string box = folder.write("box.obj", mesh_bytes(make_box({0, 0, 0}, {1, 1, 2}), "mesh.obj"));
  const std::string bad = folder.write("bad.obj", "f 1 2 3\n");
  const std::string out = folder.file("out/");
  Run run = convert_many({bad, box, out}, {"--jobs", "1"});
  CHECK(run.exit == 3);
  CHECK(run.out.find("failed     " + bad) != std::string::npos);
  CHECK(run.out.find("0 made, 0 up to date, 1 failed, 1 not begun") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(out + "box.meso"));
  run = convert_many({bad, box, folder.file("none.stl"), out}, {"--keep-going", "--json"});
  CHECK(run.exit == 3);
  CHECK(run.json()["made"] == 1);
  CHECK(run.json()["failed"] == 2);
  CHECK(run.json()["files"][0]["message"].get<std::string>().find("uses vertex") != std::string::npos);
  CHECK(run.json()["files"][2]["exit"] == 3);
  CHECK(std::filesystem::exists(out + "box.meso"));
  CHECK_FALSE(std::filesystem::exists(out + "bad.meso"));
}

TEST_CASE("mistakes with batches end with 2 and say what to do") {
  const TempFolder folder;
  const std::string list = folder.write("list.txt", "# nothing\n"), box = folder.write("box.obj", "");
  for (const auto& [words, hint] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"@" + list, folder.file("out/")}, "names no file"},
           {{"@" + list, folder.file("out.meso")}, "end its name with /"},
           {{box, folder.file("out/"), "--to", "a/b"}, "no extension"},
           {{box, folder.file("out/"), "--jobs", "0"}, "--jobs"}}) {
    const Run run = convert_many(words);
    INFO(run.err);
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
    CHECK(run.err.find(hint) != std::string::npos);
  }
  const Run missing = convert_many({"@" + folder.file("none.txt"), folder.file("out/")});
  CHECK(missing.exit == 3);
  const Run blocked = convert_many({box, box, folder.write("file", "x") + "/"});
  CHECK(blocked.exit == 4);
}

TEST_CASE("an interrupted batch leaves whole files and begins there again") {
  const TempFolder folder;
  std::vector<std::string> words;
  for (int k = 0; k < 12; ++k)
    words.push_back(folder.write("box" + std::to_string(k) + ".obj",
                                 mesh_bytes(make_box({0, 0, 0}, {1, 1, 1.0 + k}), "mesh.obj")));
  const std::string out = folder.file("out/");
  words.push_back(out);
  RunOptions options;
  options.signal_after = std::chrono::milliseconds(400);
  options.signal = SIGINT;
  const std::vector<std::string> slow = {"--json", "--jobs", "1", "--color", "marble:resolution=64"};
  const Run run = convert_many(words, slow, options);
  CHECK(run.exit == 130);
  const auto made = run.json()["made"].get<int>();
  CHECK(made < 12);
  int found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    if (entry.path().extension() != ".meso") continue;
    CHECK(run_command({"validate", entry.path().string()}).exit == 0);
    ++found;
  }
  CHECK(found >= made);
  const Run again = convert_many(words, slow);
  CHECK(again.exit == 0);
  CHECK(again.json()["up_to_date"].get<int>() >= made);
  CHECK(again.json()["made"].get<int>() + again.json()["up_to_date"].get<int>() == 12);
}

TEST_CASE("a batch that is killed takes its processes with it") {
  const TempFolder folder;
  const std::string out = folder.file("out/");
  RunOptions options;
  options.signal_after = std::chrono::milliseconds(500);
  options.signal = SIGKILL;
  const Run run =
      run_command({"convert", "shape:wavy:detail=8", "shape:knot:detail=8", out, "--tiles", "64"}, options);
  CHECK(run.exit == -SIGKILL);
  std::size_t left = 1;
  for (int k = 0; k < 100 && left > 0; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    left = 0;
    for (const auto& process : std::filesystem::directory_iterator("/proc")) {
      std::ifstream file(process.path() / "cmdline", std::ios::binary);
      const std::string words{std::istreambuf_iterator<char>(file), {}};
      left += words.find(folder.path()) != words.npos;
    }
  }
  CHECK(left == 0);
}
