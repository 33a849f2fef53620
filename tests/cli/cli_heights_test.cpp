#include <iostream>
#include <string>
#include <vector>

#include "tests/cli/picture_scene.h"
#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// A slope from 0 at the left to the full value at the right.
PlainPicture slope(std::uint32_t width, std::uint32_t height, std::uint32_t full) {
  PlainPicture picture{width, height, 1, {}};
  for (std::uint32_t j = 0; j < height; ++j)
    for (std::uint32_t i = 0; i < width; ++i) picture.samples.push_back(i * full / (width - 1));
  return picture;
}

Run convert_heights(const std::string& input, const std::string& output, const std::string& heights) {
  std::vector<std::string> words = {
      "convert", input, output, "--tiles", "16", "--tile", "voronoi:cells=8,resolution=16,seed=1", "--json"};
  if (!heights.empty()) words.insert(words.end(), {"--heights", heights});
  return run_command(words);
}

double inside(const Run& run) { return run.json()["volume"]["inside"].get<double>(); }

}  // namespace

TEST_CASE("a picture is a block of ground, whose size and sense the options say") {
  const TempFolder folder;
  const std::string png = folder.write("slope.png", png_bytes(slope(64, 64, 255)));
  const std::string out = folder.file("a.meso");
  // 4 × 4 m, rising from 0 to 2 m, over a floor at -1 m: 32 m³ in all, less what cells at the surface lose.
  const Run run = convert_heights(png, out, "spacing=0.0625,scale=2,zero=0,floor=-1");
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(inside(run) < 32);
  CHECK(inside(run) > 22);
  CHECK(run.json()["metadata"]["heights"] ==
        "heights:as=block,channel=Y,floor=-1,scale=2,spacing=0.0625,up=white,values=scaled,zero=0");
  // The other way up it is as large.
  const Run black =
      convert_heights(png, folder.file("b.meso"), "spacing=0.0625,scale=2,zero=1,floor=-1,up=black");
  CHECK(std::abs(inside(black) - inside(run)) < 1);
  // As a mesh it is half a spacing smaller all around, and can be compared with it.
  const Run mesh =
      convert_heights(png, folder.file("c.meso"), "spacing=0.0625,scale=2,zero=0,floor=-1,as=mesh");
  INFO(mesh.err);
  REQUIRE(mesh.exit == 0);
  CHECK(mesh.json()["volume"]["mesh"].get<double>() == Approx(3.9375 * 3.9375 * 2).epsilon(5e-3));
  CHECK(std::abs(inside(mesh) - inside(run)) < 2);
  // Integers as they stand.
  const Run stored = convert_heights(png, folder.file("d.meso"),
                                     "spacing=0.0625,scale=0.00784313725490196,floor=-1,values=stored");
  CHECK(inside(stored) == Approx(inside(run)).epsilon(0.02));
  // By itself it fills its box somehow.
  CHECK(convert_heights(png, folder.file("e.meso"), "").exit == 0);
}

TEST_CASE("heights that are missing are holes") {
  const TempFolder folder;
  PlainPicture picture = slope(32, 32, 255);
  for (std::uint32_t j = 0; j < 16; ++j)
    for (std::uint32_t i = 0; i < 32; ++i) picture.samples[i + 32 * j] = 7;
  const std::string png = folder.write("slope.png", png_bytes(picture));
  const Run all = convert_heights(png, folder.file("a.meso"), "scale=0.2,zero=0,floor=-0.5");
  const Run half = convert_heights(png, folder.file("b.meso"), "scale=0.2,zero=0,floor=-0.5,nodata=7");
  REQUIRE(half.exit == 0);
  CHECK(half.err.find("512 heights are missing") != std::string::npos);
  CHECK(inside(half) < 0.6 * inside(all));
  CHECK(inside(half) > 0.4 * inside(all));
}

TEST_CASE("signed and floating heights are read as they are") {
  const TempFolder folder;
  PlainPicture picture{4, 4, 1, {}};
  for (std::uint32_t i = 0; i < 16; ++i)
    picture.samples.push_back(i < 8 ? std::uint32_t(-100) & 0xffff : 300);
  const std::string tiff = folder.write("dem.tif", tiff_bytes({picture}, {.bits = 16, .format = 2}));
  const Run run = convert_heights(tiff, folder.file("a.meso"), "values=stored,spacing=100,scale=1");
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.json()["metadata"]["heights"].get<std::string>().find("zero=-100") != std::string::npos);
  CHECK(run.json()["object_box"]["max"][1].get<double>() > 399);
}

TEST_CASE("mistakes with heights say what to do") {
  const TempFolder folder;
  const std::string png = folder.write("a.png", png_bytes(slope(8, 8, 255)));
  const std::string out = folder.file("a.meso");
  for (const char* heights :
       {"scale=0", "scale=high", "up=left", "as=cloud", "hight=2", "channel=B", "floor=9", "gamma=0"}) {
    const Run run = convert_heights(png, out, heights);
    INFO(heights << ": " << run.err);
    CHECK(run.exit == 2);
    CHECK(run.messages() == 1);
    CHECK(run.err.find("--heights") != std::string::npos);
  }
  CHECK(convert_heights(folder.write("b.png", png_bytes(slope(8, 8, 255)).substr(0, 60)), out, "").exit == 3);
  CHECK(convert_heights(png, out, "nodata=0,floor=-1").exit == 0);
  const Run flat = convert_heights(
      folder.write("flat.png", png_bytes({4, 4, 1, std::vector<std::uint32_t>(16, 9)})), out, "nodata=9");
  CHECK(flat.exit == 3);
  CHECK(flat.err.find("missing") != std::string::npos);
  const Run repaired =
      run_command({"convert", png, out, "--repair", "strict", "--thicken", "1", "--quiet", "--json"});
  CHECK(repaired.exit == 2);  // by themselves these two contradict each other
  const Run solid = run_command({"convert", png, out, "--solid", "outer", "--tiles", "16", "--tile",
                                 "voronoi:cells=8,resolution=16,seed=1"});
  CHECK(solid.exit == 0);
  CHECK(solid.err.find("--solid has no effect where there is no mesh") != std::string::npos);
  const Run unused = run_command({"convert", "shape:box", out, "--heights", "scale=1"});
  CHECK(unused.exit == 0);
  CHECK(unused.err.find("--heights has no effect") != std::string::npos);
}

TEST_CASE("one terrain as 16-bit integers, half and full floats fills alike but for quantisation") {
  const auto png = find_data("heights/heightmap_16bit.png"), half = find_data("heights/heightmap_16bit.exr"),
             full = find_data("heights/heightmap_32bit.exr");
  if (!png || !half || !full) {
    WARN("skipped: no test data");
    return;
  }
  const TempFolder folder;
  // The EXR files were saved with a tone curve of 1.737, which none of them says.
  const std::string words = "scale=0.2,zero=0,floor=-0.02";
  const Run a = convert_heights(*png, folder.file("png.meso"), words + ",gamma=1.737");
  const Run b = convert_heights(*half, folder.file("half.meso"), words),
            c = convert_heights(*full, folder.file("full.meso"), words);
  REQUIRE((a.exit == 0 && b.exit == 0 && c.exit == 0));
  const auto total = c.json()["instances"]["inside"].get<int>();
  for (const char* name : {"png", "half"}) {
    const Run compared = run_command(
        {"compare", folder.file(std::string(name) + ".meso"), folder.file("full.meso"), "--json"});
    const auto differing = compared.json()["tags_differing"].get<int>();
    std::cout << "terrain as " << name << " and as full floats: " << differing << " of " << total
              << " cells inside differ\n";
    CHECK(differing <= total / 100);
  }
}

TEST_CASE("a map of heights reads back as what it was taken of") {
  const TempFolder folder;
  const std::string png = folder.write("slope.png", png_bytes(slope(64, 64, 255)));
  const std::string first = folder.file("a.meso");
  const Run made = convert_heights(png, first, "scale=0.5,floor=-0.1");
  REQUIRE(made.exit == 0);
  for (const char* name : {"h.png", "h.exr", "h.tif"}) {
    const std::string map = folder.file(name);
    const Run written = run_command({"convert", first, map, "--as", "height", "--json"});
    INFO(written.err);
    REQUIRE(written.exit == 0);
    const auto words = written.json()["heights"].get<std::string>();
    CHECK(written.json()["size"][0] == 256);
    const Run back = convert_heights(map, folder.file("b.meso"), words);
    INFO(words << ": " << back.err);
    REQUIRE(back.exit == 0);
    // What is filled twice loses cells at the surface twice.
    CHECK(inside(back) > 0.5 * inside(made));
  }
}

TEST_CASE("shapes are there without a file") {
  const TempFolder folder;
  for (const char* name : {"sphere", "box", "cylinder", "cone", "torus", "knot"}) {
    const Run run = run_command({"convert", "shape:" + std::string(name) + ":size=2", folder.file("a.meso"),
                                 "--tiles", "8", "--tile", "voronoi:cells=8,resolution=16,seed=1", "--json"});
    INFO(name << run.err);
    CHECK(run.exit == 0);
    CHECK(run.err.empty());
    CHECK(run.json()["instances"]["inside"] > 20);
    CHECK(run.json()["metadata"]["shape"] == std::string(name) + ":size=2");
  }
  const Run unknown = run_command({"convert", "shape:dodo", folder.file("a.meso")});
  CHECK(unknown.exit == 2);
  CHECK(unknown.err.find("torus") != std::string::npos);
}
