#include <nlohmann/json.hpp>
#include <string>
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

Run convert(const std::string& input, const std::string& output, const std::vector<std::string>& more) {
  std::vector<std::string> words = {"convert", input, output, "--tiles", "4"};
  words.insert(words.end(), more.begin(), more.end());
  Run run = run_command(words);
  INFO(run.err);
  REQUIRE(run.exit == 0);
  return run;
}

json losses(const std::string& input, const std::string& output, std::vector<std::string> more = {}) {
  more.push_back("--json");
  return convert(input, output, more).json()["losses"];
}

}  // namespace

TEST_CASE("a conversion says what of a mesh is not kept") {
  const TempFolder folder;
  const std::string out = folder.file("a.meso");
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 2});
  CHECK(losses("shape:sphere", out).empty());
  CHECK(losses(folder.write("plain.ply", mesh_bytes(box, "little.ply")), out).empty());
  box.colors.assign(8, {200, 0, 0});
  const std::string path = folder.write("a.obj", "vn 0 0 1\n" + mesh_bytes(box, "mesh.obj"));
  CHECK(losses(path, out) == json{"colors of vertices", "normals"});
  CHECK(losses(path, out, {"--keep-mesh"}) == json{"normals"});
  CHECK(losses(path, out, {"--color", "mesh"}) == json{"normals"});
  CHECK(losses(path, out, {"--color", "wood"}) == json{"colors of vertices", "normals"});
  CHECK(losses("shape:sphere", out, {"--tile", "mesh:resolution=8,file=" + path}) ==
        json{"colors of vertices", "normals"});
  CHECK(convert(path, out, {}).out.find("\n  not kept: colors of vertices\n  not kept: normals\n") !=
        std::string::npos);
  CHECK(convert(path, out, {"--color", "mesh"}).out.find("colors of vertices") == std::string::npos);
}

TEST_CASE("a conversion says what of heights, slices and scans is not kept") {
  const TempFolder folder;
  const std::string out = folder.file("a.meso");
  std::vector<std::uint32_t> samples;
  for (std::uint32_t i = 0; i < 3 * 64; ++i) samples.push_back(i);
  const std::string picture = folder.write("a.png", png_bytes({8, 8, 3, samples}));
  CHECK(losses(picture, out) == json{"channel B", "channel G"});
  CHECK(losses(picture, out, {"--heights", "channel=G"}) == json{"channel B", "channel R"});
  samples.resize(64);
  CHECK(losses(folder.write("b.png", png_bytes({8, 8, 1, samples})), out).empty());
  CHECK(losses("shape:sphere", out, {"--tile", "heights:resolution=8,file=" + picture}) ==
        json{"channel B", "channel G"});
  const PlainPicture rgba{4, 4, 4, std::vector<std::uint32_t>(64, 9)};
  CHECK(losses("shape:sphere", out, {"--color", "image:file=" + folder.write("c.png", png_bytes(rgba))}) ==
        json{"alpha"});
  std::string numbers;
  for (int i = 0; i < 64; ++i) numbers += char(i);
  const auto scan = [&](const std::string& more) {
    return losses(folder.write("a.mha", "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\n" + more +
                                            "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + numbers),
                  out);
  };
  CHECK(scan("BinaryData = True\nElementSpacing = 1 1 2\n").empty());
  CHECK(scan("Modality = MET_MOD_CT\nAnatomicalOrientation = RAI\n") ==
        json{"field AnatomicalOrientation", "field Modality"});
}
