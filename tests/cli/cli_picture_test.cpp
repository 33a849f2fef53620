#include <limits>
#include <string>
#include <vector>

#include "converters/image/image_file.h"
#include "tests/cli/picture_scene.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

/// What another program reads in a picture, as text; empty if that program is not installed.
std::string dump(const std::string& path) {
  const std::string tool = MESOCELL_OIIOTOOL;
  if (tool.empty() || tool.ends_with("NOTFOUND")) return {};
  return run_program(tool, {"--info", "-v", "--dumpdata", path}).out;
}

}  // namespace

TEST_CASE("render --json keeps its contract in every mode and method") {
  const Scene scene;
  for (const std::string mode : {"first-hit", "depth", "cell", "normal", "color"})
    for (const std::string method : {"exact", "linear:1/64"}) {
      INFO(mode << " " << method);
      const Run run = scene.render("p.png", {"--mode", mode, "--method", method, "--json"});
      REQUIRE(run.exit == 0);
      CHECK(run.err.empty());
      const json result = run.json();
      CHECK(result["width"] == 48);
      CHECK(result["height"] == 32);
      CHECK(result["rays"] == 48 * 32);
      CHECK(result["hits"] > 100);
      CHECK(result["hits"] < 48 * 32);
      CHECK(result["seconds"].is_number());
      CHECK(result["rays_per_second"] > 0);
      CHECK(result["method"] == method);
      CHECK(result["mode"] == mode);
      const std::string bytes = read_bytes(scene.folder.file("p.png"));
      REQUIRE(bytes.size() > 100);
      CHECK(bytes.substr(1, 3) == "PNG");
      CHECK(bytes.substr(16, 8) == std::string("\0\0\0\x30\0\0\0\x20", 8));
    }
}

TEST_CASE("the same picture has the same bytes, whatever the threads and the time") {
  const Scene scene;
  for (const char* name : {"a.png", "a.exr"}) {
    REQUIRE(scene.render(name, {"--threads", "1"}).exit == 0);
    const std::string first = read_bytes(scene.folder.file(name));
    // Image files like to hold the time, to the second.
    CHECK(run_program("/bin/sleep", {"1.1"}).exit == 0);
    REQUIRE(scene.render(name, {"--threads", "2"}).exit == 0);
    CHECK(read_bytes(scene.folder.file(name)) == first);
  }
}

TEST_CASE("depth: infinite where nothing is hit, and the same by both ways") {
  const Scene scene;
  REQUIRE(scene.render("d.exr", {"--mode", "depth"}).exit == 0);
  REQUIRE(scene.render("c.png", {"--depth", scene.folder.file("e.exr")}).exit == 0);
  CHECK(read_bytes(scene.folder.file("d.exr")).find("compression") != std::string::npos);
  const Image layers = read_picture(scene.folder.file("d.exr")),
              depth = read_picture(scene.folder.file("e.exr"));
  CHECK(depth.channels == std::vector<std::string>{"Z"});
  REQUIRE(find_channel(layers, "depth.Z"));
  const std::size_t z = *find_channel(layers, "depth.Z"), stride = layers.channels.size();
  std::size_t misses = 0;
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    REQUIRE(layers.pixels[i * stride + z] == depth.pixels[i]);
    misses += depth.pixels[i] == std::numeric_limits<float>::infinity();
  }
  CHECK(misses > 100);
  CHECK(misses < depth.pixels.size());
}

TEST_CASE("camera, and what makes no sense of it") {
  const Scene scene;
  const Run away = scene.render("p.png", {"--eye", "0,0,9", "--look", "0,0,10", "--up", "0,1,0", "--json"});
  CHECK(away.json()["hits"] == 0);
  const Run there = scene.render("p.png", {"--eye", "0,0,9", "--look", "0,0,0", "--fov", "20", "--json"});
  CHECK(there.json()["hits"] > 200);
  CHECK(scene.render("q.png", {"--eye", "-3,-.5,+2"}).exit == 0);
  CHECK(scene.render("q.png", {"--eye", "-.5,-3,2"}).exit == 0);
  const std::vector<std::string> before = scene.folder.list();
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{"--eye", "1,2"},
                                             {"--eye", "1,2,nan"},
                                             {"--eye", "1,2,inf"},
                                             {"--look", "a,b,c"},
                                             {"--up", "0,0,0"},
                                             {"--eye", "1,2,3,4"},
                                             {"--fov", "0"},
                                             {"--fov", "180"},
                                             {"--fov", "nan"},
                                             {"--size", "0x32"},
                                             {"--size", "48"},
                                             {"--size", "16385x1"},
                                             {"--size", "48x32x1"},
                                             {"--size", "-4x4"},
                                             {"--mode", "sepia"},
                                             {"--method", "sphere"},
                                             {"--method", "linear:0"},
                                             {"--method", "linear:x"},
                                             {"--method", "linear:-1"},
                                             {"--samples", "0"},
                                             {"--samples", "4097"},
                                             {"--bounces", "-1"},
                                             {"--bounces", "1001"},
                                             {"--events", "many"},
                                             {"--ao", "4097"},
                                             {"--reflectivity", "1.1"},
                                             {"--reflectivity", "nan"},
                                             {"--ior", "0.9"},
                                             {"--ior", "inf"},
                                             {"--light", "0,0,0"},
                                             {"--light", "1e200,0,0"},
                                             {"--clip", "0,0,0,1"},
                                             {"--clip", "1,0,0"},
                                             {"--clip", "1,0,0,inf"},
                                             {"--env", "sky.bmp"},
                                             {"--eye", "1,1,1", "--look", "1,1,1"},
                                             {"--depth", "d.png"}}) {
    INFO(bad[0] << " " << bad[1]);
    const Run run = scene.render("r.png", bad);
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
  }
  CHECK(scene.folder.list() == before);
}

TEST_CASE("where the picture goes is checked before the work") {
  const Scene scene;
  const std::vector<std::string> before = scene.folder.list();
  CHECK(scene.render("p.bmp").exit == 2);
  CHECK(scene.render("p").exit == 2);
  CHECK(scene.render("ball.meso").exit == 2);
  CHECK(scene.render("p.exr", {"--depth", scene.folder.file("p.exr")}).exit == 2);
  CHECK(scene.render("missing/p.png").exit == 4);
  CHECK(scene.render("p.png", {"--depth", scene.folder.file("missing/d.exr")}).exit == 4);
  CHECK(scene.folder.list() == before);
  scene.folder.write("old.png", "the old file");
  CHECK(scene.render("old.png", {"--no-clobber"}).exit == 4);
  CHECK(read_bytes(scene.folder.file("old.png")) == "the old file");
  // A picture by the name of the asset, through a link.
  CHECK(run_command({"render", scene.asset, scene.asset}).exit == 2);
  CHECK(run_command({"render", scene.folder.file("missing.meso"), scene.folder.file("p.png")}).exit == 3);
}

TEST_CASE("without the image module there is a message, and no picture") {
  const Scene scene;
  const std::vector<std::string> before = scene.folder.list();
  RunOptions options;
  options.environment = {"MESOCELL_MODULE_PATH=" + scene.folder.path()};
  const Run run = run_command({"render", scene.asset, scene.folder.file("p.png"), "--size", "4x4"}, options);
  CHECK(run.exit == 4);
  CHECK(run.messages() == 1);
  CHECK(run.err.find("MESOCELL_MODULE_PATH") != std::string::npos);
  CHECK(scene.folder.list() == before);
}

TEST_CASE("pixel values arrive as they should") {
  const TempFolder folder;
  const std::vector<std::string> gray = {"Y"}, color = {"R", "G", "B", "A"};
  const std::vector<float> values = {0.0f, 0.5f, 1.0f, -1.0f, 7.0f, std::numeric_limits<float>::infinity()};
  find_image_module();
  const std::string png = folder.file("v.png"), exr = folder.file("v.exr"), rgba = folder.file("c.png");
  REQUIRE(write_image_file(png, {6, 1, gray, values}).ok());
  REQUIRE(write_image_file(exr, {6, 1, gray, values}).ok());
  const std::vector<float> half = {1.0f, 0.5f, 0.0f, 0.5f};
  REQUIRE(write_image_file(rgba, {1, 1, color, half}).ok());
  CHECK(write_image_file(folder.file("v.tif"), {6, 1, gray, values}).error().code == ErrorCode::kUsage);
  const std::string text = dump(png);
  if (text.empty()) {
    WARN("skipped: oiiotool is not installed");
    return;
  }
  INFO(text << dump(exr) << dump(rgba));
  // sRGB of linear 0.5 is 187.516 of 255.
  for (const char* pixel : {"Pixel (0, 0): 0 ", "Pixel (1, 0): 188 ", "Pixel (2, 0): 255 ",
                            "Pixel (3, 0): 0 ", "Pixel (4, 0): 255 ", "Pixel (5, 0): 255 "})
    CHECK(text.find(pixel) != std::string::npos);
  const std::string floats = dump(exr);
  for (const char* pixel : {"Pixel (1, 0): 0.5", "Pixel (3, 0): -1", "Pixel (4, 0): 7", "Pixel (5, 0): inf"})
    CHECK(floats.find(pixel) != std::string::npos);
}
