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

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

/// Writes a picture one pixel high and returns its path.
std::string picture(const TempFolder& folder, const std::string& name,
                    const std::vector<std::string>& channels, const std::vector<float>& values) {
  find_image_module();
  const std::string path = folder.file(name);
  const std::uint32_t width = std::uint32_t(values.size() / channels.size());
  REQUIRE(write_image_file(path, {width, 1, channels, values}).ok());
  return path;
}

/// Runs compare with --json and checks what holds for every result.
json compare(const std::string& a, const std::string& b, int exit, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"compare", a, b, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const Run run = run_command(words);
  INFO(run.err);
  CHECK(run.exit == exit);
  CHECK(run.err.empty());
  const json result = run.json();
  CHECK(result["equal"] == (exit == 0));
  CHECK(result["differences"].empty() == (exit == 0));
  // The help text has the keys that scripts may rely on.
  static const std::string help = run_command({"compare", "--help"}).out;
  for (const auto& [key, value] : result.items()) CHECK(help.find(key) != std::string::npos);
  return result;
}

}  // namespace

TEST_CASE("figures of two pictures are those of the definition") {
  const TempFolder folder;
  const std::vector<std::string> rgb = {"R", "G", "B"};
  const std::string a = picture(folder, "a.exr", rgb, {0, 0.5f, 1, 0.25f, 0.25f, 0.25f});
  const std::string b = picture(folder, "b.exr", rgb, {0, 0.5f, 0.5f, 0.25f, 0.5f, 0.25f});
  const json same = compare(a, a, 0);
  CHECK(same["kind"] == "picture");
  CHECK(same["width"] == 2);
  CHECK(same["height"] == 1);
  CHECK(same["channels"] == json(rgb));
  CHECK(same["tolerance"] == 0.0);
  CHECK(same["max"] == 0.0);
  CHECK(same["rmse"] == 0.0);
  CHECK(same["psnr"].is_null());
  for (const auto& [first, second] : {std::pair(a, b), std::pair(b, a)}) {
    const json other = compare(first, second, 1);
    CHECK(other["differences"] == json({"values"}));
    CHECK(other["max"] == Approx(0.5));
    CHECK(other["mean"] == Approx(0.75 / 6));
    const double rmse = std::sqrt((0.25 + 0.0625) / 6);
    CHECK(other["rmse"] == Approx(rmse));
    CHECK(other["psnr"] == Approx(-20 * std::log10(rmse)));
    CHECK(compare(first, second, 1, {"--tolerance", "0.49"})["tolerance"] == Approx(0.49));
    CHECK(compare(first, second, 0, {"--tolerance", "0.5"})["max"] == Approx(0.5));
  }
}

TEST_CASE("infinities equal each other and nothing else") {
  const TempFolder folder;
  const std::vector<std::string> z = {"Z"};
  const std::string a = picture(folder, "a.exr", z, {kInf, -kInf, kNan, 3});
  CHECK(compare(a, a, 0)["max"] == 0.0);
  for (const std::vector<float>& values :
       {std::vector<float>{kInf, -kInf, 0, 3}, {kInf, kInf, kNan, 3}, {1e30f, -kInf, kNan, 3}}) {
    const json result = compare(a, picture(folder, "b.exr", z, values), 1, {"--tolerance", "1"});
    CHECK(result["max"].is_null());
    CHECK(result["rmse"].is_null());
  }
  CHECK(compare(a, picture(folder, "b.exr", z, {kInf, -kInf, kNan, 3.5f}), 0,
                {"--tolerance", "0.5"})["max"] == Approx(0.5));
}

TEST_CASE("values of 8 bits are compared as they are, with floats as light") {
  const TempFolder folder;
  const std::vector<std::string> rgba = {"R", "G", "B", "A"};
  const std::vector<float> values = {0.5f, 0.25f, 1, 0.5f};
  const std::string png = picture(folder, "a.png", rgba, values);
  // Light 0.5 stands as 188 in sRGB, 0.46 as 180; alpha has no curve and is not multiplied in.
  const json result = compare(png, picture(folder, "b.png", rgba, {0.4564110f, 0.25f, 1, 0.5f}), 1);
  CHECK(result["max"] == Approx(8 / 255.0).epsilon(1e-5));
  const json light = compare(png, picture(folder, "c.exr", rgba, values), 0, {"--tolerance", "0.004"});
  CHECK(light["channels"] == json(rgba));
  CHECK(light["max"] > 1e-5);
}

TEST_CASE("pictures of unequal size or channels differ, with a message") {
  const TempFolder folder;
  const std::vector<std::string> z = {"Z"}, y = {"Y"}, yz = {"Y", "Z"};
  const std::string a = picture(folder, "a.exr", z, {1, 2, 3});
  const json size = compare(a, picture(folder, "b.exr", z, {1, 2}), 1, {"--tolerance", "1"});
  CHECK(size["differences"] == json({"size"}));
  CHECK(size["max"].is_null());
  CHECK(compare(a, picture(folder, "c.exr", y, {1, 2, 3}), 1)["differences"] == json({"channels"}));
  CHECK(compare(a, picture(folder, "d.exr", yz, {1, 1, 2, 2, 3, 3}), 1)["differences"] == json({"channels"}));
  const Run run = run_command({"compare", a, folder.file("b.exr")});
  CHECK(run.out.find("3 x 1") != std::string::npos);
  CHECK(run.out.find("2 x 1") != std::string::npos);
  CHECK(run.exit == 1);
  CHECK(run_command({"compare", a, folder.file("b.exr"), "--quiet"}).exit == 1);
  CHECK(run_command({"compare", a, a, "--quiet"}).out.empty());
}

TEST_CASE("what cannot be read is 3, over a limit 5") {
  const TempFolder folder;
  const std::string good = folder.write("good.hdr", hdr_bytes(2, 1, 128, 129, 2));
  CHECK(compare(good, good, 0)["channels"] == json({"R", "G", "B"}));
  folder.write("cut.hdr", hdr_bytes(64, 64, 128, 129, 2));
  folder.write("huge.hdr", hdr_bytes(1000000, 1000000, 128, 129, 2));
  folder.write("text.png", "Dear Sir or Madam,");
  folder.write("text.meso", "Dear Sir or Madam,");
  const auto exit = [&](const std::string& a, const std::string& b) {
    const Run run = run_command({"compare", a, b});
    INFO(a << " " << b << " " << run.err);
    CHECK(run.messages() == 1);
    CHECK(run.out.empty());
    return run.exit;
  };
  for (const char* name : {"cut.hdr", "text.png", "missing.exr"}) {
    CHECK(exit(folder.file(name), good) == 3);
    CHECK(exit(good, folder.file(name)) == 3);
  }
  CHECK(exit(folder.file("text.meso"), folder.file("text.meso")) == 3);
  CHECK(exit(good, folder.file("huge.hdr")) == 5);
  CHECK(run_program("/bin/mkdir", {folder.file("folder.png")}).exit == 0);
  CHECK(exit(good, folder.file("folder.png")) == 3);
  CHECK(run_program("/usr/bin/mkfifo", {folder.file("pipe.hdr")}).exit == 0);
  CHECK(exit(good, folder.file("pipe.hdr")) == 3);
}

TEST_CASE("equal assets are equal, and their parts are told where they are not") {
  const Scene plain, again, conservative({"--rule", "conservative"}),
      marble({"--color", "marble:resolution=8"}), cells({"--color", "cells"}), normals({"--normals"}),
      moved({"--box", "-2,-1,-1,1,1,1"});
  const json same = compare(plain.asset, again.asset, 0);
  CHECK(same["kind"] == "asset");
  CHECK(same["tags_differing"] == 0);
  CHECK(same["voxels_differing"] == 0);
  CHECK(same["box_distance"] == 0.0);
  CHECK(same["metadata_differing"] == json::array());
  CHECK(same["instances"]["a"] == same["instances"]["b"]);

  const json rule = compare(plain.asset, conservative.asset, 1);
  CHECK(rule["differences"] == json({"rule", "tags"}));
  // Conservative only turns tags to INTERSECTED, so the counts tell how many differ.
  CHECK(rule["tags_differing"] ==
        rule["instances"]["b"]["intersected"].get<int>() - rule["instances"]["a"]["intersected"].get<int>());
  const json color = compare(plain.asset, marble.asset, 1);
  CHECK(color["differences"] == json({"color", "metadata"}));
  CHECK(color["metadata_differing"] == json({"color"}));
  CHECK(compare(plain.asset, cells.asset, 1)["differences"] == json({"cell_colors", "metadata"}));
  CHECK(compare(normals.asset, plain.asset, 1)["differences"] == json({"normals"}));
  const json box = compare(plain.asset, moved.asset, 1);
  CHECK(box["tags_differing"].is_null());
  CHECK(box["voxels_differing"] == 0);
  CHECK(box["box_distance"] == Approx(1).epsilon(0.1));
}

TEST_CASE("tiles are compared voxel by voxel, and a tolerance is for pictures") {
  const Scene plain, other({"--tile", "voronoi:cells=8,resolution=16,seed=2"}),
      finer({"--tile", "voronoi:cells=8,resolution=18,seed=1"});
  const json tile = compare(plain.asset, other.asset, 1);
  CHECK(tile["voxels_differing"] > 1000);
  CHECK(tile["voxels_differing"] <= 16 * 16 * 16);
  CHECK(tile["tags_differing"] > 0);
  CHECK(tile["metadata_differing"] == json({"tile"}));
  CHECK(compare(plain.asset, finer.asset, 1)["voxels_differing"].is_null());
  const Run run = run_command({"compare", plain.asset, plain.asset, "--tolerance", "0.5"});
  CHECK(run.exit == 0);
  CHECK(run.messages() == 1);
  CHECK(run.err.find("warning") != std::string::npos);
  const Run text = run_command({"compare", plain.asset, other.asset});
  CHECK(text.exit == 1);
  CHECK(text.out.find("voxels_differing") != std::string::npos);
}
