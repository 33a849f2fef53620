#include <cmath>
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

float pixel(const Image& image, std::size_t i, const char* channel) {
  const auto c = find_channel(image, channel);
  REQUIRE(c);
  return image.pixels[i * image.channels.size() + *c];
}

/// Sum over the pixels of a channel.
double total(const Image& image, const char* channel) {
  double sum = 0;
  for (std::size_t i = 0; i < std::size_t{image.width} * image.height; ++i) sum += pixel(image, i, channel);
  return sum;
}

Image render_layers(const Scene& scene, const std::vector<std::string>& more) {
  const Run run = scene.render("l.exr", more);
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.err.empty());
  return read_picture(scene.folder.file("l.exr"));
}

}  // namespace

TEST_CASE("an .exr of any mode holds the same layers") {
  const Scene scene({"--color", "cells", "--normals"});
  Image first;
  for (const std::string mode : {"first-hit", "depth", "cell", "normal", "color"}) {
    INFO(mode);
    const Image image = render_layers(scene, {"--mode", mode});
    CHECK(image.width == 48);
    CHECK(image.height == 32);
    CHECK(image.channels.size() == 11);
    if (first.pixels.empty()) first = image;
    for (const char* name :
         {"depth.Z", "normal.X", "normal.Y", "normal.Z", "color.R", "color.G", "color.B", "cell.id"})
      for (std::size_t i = 0; i < 48 * 32; ++i) REQUIRE(pixel(image, i, name) == pixel(first, i, name));
    std::size_t hits = 0;
    for (std::size_t i = 0; i < 48 * 32; ++i) {
      const bool hit = pixel(image, i, "cell.id") > 0;
      hits += hit;
      REQUIRE(std::isinf(pixel(image, i, "depth.Z")) == !hit);
      if (mode == "color") REQUIRE(pixel(image, i, "R") == pixel(image, i, "color.R"));
      if (mode == "normal" && hit)
        REQUIRE(pixel(image, i, "G") == Approx(0.5 + 0.5 * pixel(image, i, "normal.Y")).margin(1e-6));
    }
    CHECK(hits > 100);
  }
}

TEST_CASE("a mirror and a clear object in an even environment are not to be seen") {
  const Scene scene;
  const std::string env = scene.folder.write("even.hdr", hdr_bytes(2, 1, 192, 128, 2));  // 0.75
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--bounces", "8"}, {"--ior", "1.5", "--events", "20"}}) {
    INFO(options[0]);
    std::vector<std::string> words = options;
    words.insert(words.end(), {"--env", env});
    const Image image = render_layers(scene, words);
    for (std::size_t i = 0; i < 48 * 32; ++i)
      for (const char* name : {"R", "G", "B"}) REQUIRE(pixel(image, i, name) == Approx(0.75).epsilon(1e-5));
  }
  const Image half = render_layers(scene, {"--env", env, "--bounces", "8", "--reflectivity", "0"});
  CHECK(total(half, "G") != Approx(0.75 * 48 * 32).epsilon(1e-3));
}

TEST_CASE("an environment is seen where the camera looks, from any format") {
  const Scene scene;
  find_image_module();
  // Left half dark, right half light: the right one is seen along +x.
  const std::vector<std::string> rgb = {"R", "G", "B"};
  std::vector<float> pixels;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) pixels.insert(pixels.end(), 3, x < 4 ? 0.0f : 0.5f);
  for (const char* name : {"sky.png", "sky.exr"}) {
    INFO(name);
    const std::string env = scene.folder.file(name);
    REQUIRE(write_image_file(env, {8, 4, rgb, pixels}).ok());
    const auto sky = [&](const char* look) {
      const Image image = render_layers(scene, {"--env", env, "--eye", "0,9,0", "--look", look});
      return pixel(image, 24 + 48 * 16, "R");
    };
    // 8 bits of sRGB: 0.5 is off by less than 1/255 of the curve there.
    CHECK(sky("5,9,0") == Approx(0.5).margin(0.004));
    CHECK(sky("-5,9,0") == Approx(0).margin(1e-6));
  }
}

TEST_CASE("an environment that cannot be used ends with 3 or 5 and leaves nothing") {
  const Scene scene;
  find_image_module();
  const std::vector<std::string> names = {"R", "G", "B"}, other = {"Z"};
  const std::vector<float> negative = {1, 1, -1}, endless = {std::numeric_limits<float>::infinity()};
  REQUIRE(write_image_file(scene.folder.file("negative.exr"), {1, 1, names, negative}).ok());
  REQUIRE(write_image_file(scene.folder.file("depth.exr"), {1, 1, other, endless}).ok());
  scene.folder.write("cut.hdr", hdr_bytes(100, 100, 128, 129, 50));
  scene.folder.write("huge.hdr", hdr_bytes(100000, 100000, 128, 129, 50));
  scene.folder.write("empty.hdr", "");
  scene.folder.write("mesh.png", "OFF\n");
  scene.folder.write("swapped.png", hdr_bytes(2, 1, 128, 129, 2));
  const std::string exr = read_bytes(scene.folder.file("negative.exr"));
  scene.folder.write("cut.exr", exr.substr(0, exr.size() - 5));
  const std::vector<std::string> before = scene.folder.list();
  const auto check = [&](const char* name, int exit) {
    INFO(name);
    const Run run = scene.render("p.png", {"--env", scene.folder.file(name)});
    INFO(run.err);
    CHECK(run.exit == exit);
    CHECK(run.messages() == 1);
    CHECK(run.err.find(name) != std::string::npos);
    CHECK(run.err.find("; ") != std::string::npos);
    CHECK(scene.folder.list() == before);
  };
  for (const char* name : {"negative.exr", "depth.exr", "cut.hdr", "cut.exr", "empty.hdr", "mesh.png",
                           "swapped.png", "missing.hdr"})
    check(name, 3);
  check("huge.hdr", 5);
  const Run same = scene.render("negative.exr", {"--env", scene.folder.file("negative.exr")});
  CHECK(same.exit == 2);
  CHECK(read_bytes(scene.folder.file("negative.exr")) == exr);
}

TEST_CASE("light, occlusion and samples change the picture, and only that") {
  const Scene scene;
  const Image plain = render_layers(scene, {});
  const Image lit = render_layers(scene, {"--light", "1,1,1"}),
              behind = render_layers(scene, {"--light", "-1,-1,-1"});
  CHECK(total(lit, "G") > total(behind, "G") + 5);
  CHECK(total(render_layers(scene, {"--ao", "32"}), "G") < total(plain, "G"));
  const Image many = render_layers(scene, {"--samples", "16"});
  const bool smoother = many.pixels != plain.pixels;
  CHECK(smoother);
  for (std::size_t i = 0; i < 48 * 32; ++i) REQUIRE(pixel(many, i, "depth.Z") == pixel(plain, i, "depth.Z"));
  REQUIRE(scene.render("a.png", {"--samples", "4", "--ao", "8", "--threads", "1"}).exit == 0);
  REQUIRE(scene.render("b.png", {"--samples", "4", "--ao", "8", "--threads", "2"}).exit == 0);
  CHECK(read_bytes(scene.folder.file("a.png")) == read_bytes(scene.folder.file("b.png")));
}

TEST_CASE("a cut keeps what is below its plane") {
  const Scene scene;
  // Seen from +z: a ball of radius 1, cut at z = 0.25 and, by a plane of another length, at z = 0.25 too.
  const std::vector<std::string> camera = {"--eye", "0,0,9", "--look", "0,0,0", "--fov", "15"};
  const auto cut = [&](const char* plane) {
    std::vector<std::string> words = camera;
    words.insert(words.end(), {"--clip", plane});
    return render_layers(scene, words);
  };
  const Image at = cut("0,0,1,0.25");
  std::size_t flat = 0;
  for (std::size_t i = 0; i < 48 * 32; ++i) {
    const double depth = pixel(at, i, "depth.Z");
    if (std::isinf(depth)) continue;
    REQUIRE(depth > 8.75 - 1e-4);
    if (pixel(at, i, "normal.Z") > 0.999f && depth < 8.9) ++flat;
  }
  CHECK(flat > 50);
  const bool scaled_is_equal = cut("0,0,4,1").pixels == at.pixels;
  CHECK(scaled_is_equal);
  const bool far_is_whole = cut("1,2,3,9").pixels == render_layers(scene, camera).pixels;
  CHECK(far_is_whole);
  CHECK(total(cut("0,0,1,-5"), "cell.id") == 0);
}

TEST_CASE("an option that has no effect warns and changes nothing") {
  const Scene scene;
  const auto warned = [&](const std::vector<std::string>& words, std::size_t count) {
    INFO(words[0] << " " << words.back());
    std::vector<std::string> with_json = words;
    with_json.push_back("--json");
    const Run run = scene.render("p.png", with_json);
    CHECK(run.exit == 0);
    CHECK(run.messages() == count);
    const json warnings = run.json()["warnings"];
    REQUIRE(warnings.size() == count);
    for (const json& warning : warnings) {
      CHECK(warning["id"] == "option-unused");
      CHECK(run.err.find(warning["text"].get<std::string>()) != std::string::npos);
    }
  };
  warned({"--mode", "first-hit"}, 0);
  const std::vector<std::string> lighting = {
      "--samples", "2", "--bounces", "2",     "--reflectivity", "0.5", "--ior", "1.5",
      "--events",  "4", "--light",   "1,1,1", "--ao",           "4",   "--env", "missing.hdr"};
  for (const std::string mode : {"depth", "cell", "normal", "color"}) {
    REQUIRE(scene.render("plain.png", {"--mode", mode}).exit == 0);
    std::vector<std::string> words = lighting;
    words.insert(words.end(), {"--mode", mode});
    warned(words, 8);
    CHECK(read_bytes(scene.folder.file("p.png")) == read_bytes(scene.folder.file("plain.png")));
  }
  warned({"--events", "3"}, 1);
  warned({"--reflectivity", "0.5"}, 1);
  warned({"--bounces", "1", "--light", "1,0,0", "--ao", "2"}, 2);
  warned({"--bounces", "1", "--light", "1,0,0", "--ao", "2", "--reflectivity", "0.5"}, 0);
  warned({"--ior", "1.3", "--light", "1,0,0", "--ao", "2", "--bounces", "2", "--reflectivity", "0.5"}, 4);
  warned({"--light", "1,0,0", "--ao", "2", "--samples", "2"}, 0);
}
