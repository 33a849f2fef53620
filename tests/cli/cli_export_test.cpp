#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "converters/image/image_reader.h"
#include "tests/cli/picture_scene.h"
#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

Run export_to(const Scene& scene, const std::string& name, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"convert", scene.asset, scene.folder.file(name), "--json"};
  words.insert(words.end(), more.begin(), more.end());
  return run_command(words);
}

}  // namespace

TEST_CASE("tile, colors and normals become stacks, and the tile and the colors come back") {
  const Scene scene({"--color", "marble:resolution=16", "--normals"});
  const std::vector<std::string> kinds = {"tile", "color"};
  for (const std::string& kind : kinds)
    for (const char* name : {"stack/", "stack.tif"}) {
      const std::string file = kind + name, path = scene.folder.file(file);
      const Run run = export_to(scene, file, {"--as", kind});
      INFO(file << run.err);
      REQUIRE(run.exit == 0);
      CHECK(run.json()["as"] == kind);
      CHECK(run.json()["slices"].get<int>() >= 8);
      const std::string back = scene.folder.file("back.meso");
      if (kind == "tile") {
        REQUIRE(run_command({"convert", "tile:labels:file=" + path, back, "--quiet"}).exit == 0);
        const Run compared = run_command({"compare", scene.asset, back, "--json"});
        // Cells that touch their own copies may be cut elsewhere.
        CHECK(compared.json()["voxels_differing"].get<double>() < 200);
      } else {
        REQUIRE(
            run_command({"convert", "tile:" + scene.asset, back, "--color", "image:file=" + path, "--quiet"})
                .exit == 0);
        for (const auto& part : run_command({"compare", scene.asset, back, "--json"}).json()["differences"])
          CHECK(part != "color");
      }
    }
  REQUIRE(export_to(scene, "n.exr", {"--as", "normal"}).exit == 0);
  find_image_module();
  const Image normals = read_picture(scene.folder.file("n.exr"));
  REQUIRE(normals.channels.size() == 3);
  int unit = 0;
  for (std::size_t i = 0; i < normals.pixels.size(); i += 3) {
    const double length = std::hypot(normals.pixels[i], normals.pixels[i + 1], normals.pixels[i + 2]);
    CHECK((length == 0 || std::abs(length - 1) < 1e-6));
    unit += length > 0.5;
  }
  CHECK(unit > 0);
}

TEST_CASE("a map of heights is what rays along the axis hit") {
  const Scene scene;  // a ball of radius 1 about the origin
  find_image_module();
  const auto box = run_command({"info", scene.asset, "--json"}).json()["object_box"];
  for (const char* side : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    INFO(side);
    REQUIRE(export_to(scene, "h.exr", {"--as", "height", "--side", side, "--size", "21x21"}).exit == 0);
    const Image map = read_picture(scene.folder.file("h.exr"));
    REQUIRE(map.width == 21);
    const std::size_t axis = std::size_t(side[1] - 'x');
    const double extent = box["max"][axis].get<double>() - box["min"][axis].get<double>();
    CHECK(std::isnan(map.pixels[0]));
    CHECK(map.pixels[21 * 10 + 10] > 0.5 * extent);
    CHECK(map.pixels[21 * 10 + 10] <= extent);
  }
}

TEST_CASE("textures for a GPU are as large as they say") {
  const Scene scene({"--color", "marble:resolution=16"});
  const Run run = export_to(scene, "gpu.json");
  INFO(run.err);
  REQUIRE(run.exit == 0);
  const auto gpu = nlohmann::json::parse(read_bytes(scene.folder.file("gpu.json")));
  for (const char* key : {"tile", "membership", "color"}) {
    const auto& texture = gpu["textures"][key];
    CHECK(std::filesystem::file_size(scene.folder.file(texture["file"])) == texture["bytes"]);
  }
  CHECK(gpu["textures"]["color"]["bytes"] == 16 * 16 * 16 * 4);
  const auto tiles = gpu["tiles"];
  CHECK(gpu["textures"]["membership"]["bytes"] ==
        tiles[0].get<int>() * tiles[1].get<int>() * tiles[2].get<int>() * 16);
}

TEST_CASE("mistakes with exports say what to do") {
  const Scene scene;
  for (const auto& [name, more, exit, hint] :
       std::vector<std::tuple<std::string, std::vector<std::string>, int, std::string>>{
           {"a.xyz", {}, 2, "--help"},
           {"a.json", {"--as", "statue"}, 2, "height"},
           {"a.json", {"--as", "tile"}, 2, ".tif"},
           {"a.exr", {"--as", "color"}, 2, "--color"},
           {"a.exr", {"--as", "normal"}, 2, "--normals"},
           {"a.png", {"--side", "up"}, 2, "+y"},
           {"a.png", {"--size", "9"}, 2, "1024x768"},
           {"no/a.png", {}, 4, "a.png"}}) {
    const Run run = export_to(scene, name, more);
    INFO(name << run.err);
    CHECK(run.exit == exit);
    CHECK(run.messages() == 1);
    CHECK(run.err.find(hint) != std::string::npos);
  }
  REQUIRE(export_to(scene, "full/").exit == 0);
  CHECK(export_to(scene, "full/").exit == 4);
  const Run unused = export_to(scene, "g.json", {"--side", "+x", "--tiles", "3"});
  CHECK(unused.exit == 0);
  CHECK(unused.messages() == 2);
  CHECK(run_command({"convert", scene.folder.file("none.meso"), scene.folder.file("a.png")}).exit == 3);
}
