#include "tests/cli/picture_scene.h"

#include <algorithm>
#include <cstdlib>

#include "tests/support/catch.h"
#include "tests/support/shapes.h"

namespace mesocell::test {

namespace {

/// Adds an option unless it is there.
void add_default(std::vector<std::string>& words, const char* option, const char* value) {
  if (std::find(words.begin(), words.end(), option) == words.end())
    words.insert(words.end(), {option, value});
}

}  // namespace

Scene::Scene(const std::vector<std::string>& more) {
  const std::string mesh = folder.write("ball.off", mesh_bytes(make_sphere({0, 0, 0}, 1, 24), "mesh.off"));
  std::vector<std::string> words = {"convert", mesh, asset, "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  add_default(words, "--tiles", "8");
  add_default(words, "--tile", "voronoi:cells=8,resolution=16,seed=1");
  const Run run = run_command(words);
  INFO(run.err);
  REQUIRE(run.exit == 0);
}

Run Scene::render(const std::string& output, const std::vector<std::string>& more) const {
  std::vector<std::string> words = {"render", asset, folder.file(output)};
  words.insert(words.end(), more.begin(), more.end());
  add_default(words, "--size", "48x32");
  return run_command(words);
}

void find_image_module() {
  const std::string command = MESOCELL_COMMAND;
  const std::string build = command.substr(0, command.rfind("/bin/"));
  REQUIRE(setenv("MESOCELL_MODULE_PATH", (build + "/lib/mesocell").c_str(), 1) == 0);
}

Image read_picture(const std::string& path) {
  find_image_module();
  const Result<Image> image = read_image_file(path);
  INFO(path << ": " << (image ? std::string() : image.error().message));
  REQUIRE(image.ok());
  return *image;
}

std::string hdr_bytes(std::uint32_t width, std::uint32_t height, std::uint8_t m, std::uint8_t e,
                      std::size_t pixels_written) {
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
                      std::to_string(width) + "\n";
  for (std::size_t i = 0; i < pixels_written; ++i) bytes += {char(m), char(m), char(m), char(e)};
  return bytes;
}

}  // namespace mesocell::test
