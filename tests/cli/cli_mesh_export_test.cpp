#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

Run convert_file(const std::string& input, const std::string& output,
                 const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"convert", input, output, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  return run_command(words);
}

/// Few voxels, so that the sanitized command is done soon.
const std::vector<std::string> kSmall = {"--tiles", "6", "--tile", "voronoi:cells=4,resolution=8,seed=2"};

/// A ball of them.
struct Ball {
  TempFolder folder;
  std::string asset = folder.file("ball.meso");
  explicit Ball(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = kSmall;
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(convert_file("shape:sphere:size=2", asset, words).exit == 0);
  }
};

nlohmann::json info_about(const std::string& path) {
  const Run run = run_command({"info", path, "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  return run.json();
}

}  // namespace

TEST_CASE("an asset's surface is a closed mesh of the volume of its voxels, in every format") {
  const Ball scene({"--color", "cells"});
  const auto inside =
      run_command({"convert", scene.folder.file("ball.obj"), scene.folder.file("again.meso"), "--json"});
  const auto asset = info_about(scene.asset);
  for (const char* name : {"s.obj", "s.ply", "s.off", "s.stl", "s.glb", "d.glb"}) {
    INFO(name);
    const std::string path = scene.folder.file(name);
    std::vector<std::string> more;
    if (name[0] == 'd') more = {"--draco", "--normals"};
    const Run run = convert_file(scene.asset, path, more);
    INFO(run.err);
    REQUIRE(run.exit == 0);
    CHECK(run.json()["as"] == "surface");
    CHECK(run.json()["bytes"] == std::filesystem::file_size(path));
    const auto mesh = info_about(path);
    CHECK(mesh["diagnosis"]["closed"] == true);
    CHECK(mesh["diagnosis"]["triangles"] == run.json()["triangles"]);
    // As the asset's: compare measures the asset against the mesh.
    const Run compared = run_command({"compare", scene.asset, path, "--json", "--samples", "2000"});
    INFO(compared.err);
    REQUIRE(compared.exit == 0);
    const auto volumes = compared.json();
    CHECK(volumes["volume"]["asset"].get<double>() ==
          Approx(volumes["volume"]["mesh"].get<double>()).epsilon(1e-5));
    CHECK(volumes["surface_distance"]["mesh_to_asset"]["max"].get<double>() < 1e-3);
  }
}

TEST_CASE("a box of tiles is cut out, and too many faces are refused with an estimate") {
  const Ball scene;
  const std::string path = scene.folder.file("s.ply");
  const Run whole = convert_file(scene.asset, path),
            part = convert_file(scene.asset, path, {"--region", "0,0,0,2,2,2"});
  REQUIRE((whole.exit == 0 && part.exit == 0));
  CHECK(part.json()["faces"] < whole.json()["faces"]);
  CHECK(info_about(path)["diagnosis"]["closed"] == true);
  std::filesystem::remove(path);
  const Run refused = convert_file(scene.asset, path, {"--max-faces", "10"});
  CHECK(refused.exit == 5);
  CHECK(refused.err.find(std::to_string(whole.json()["faces"].get<int>())) != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(path));
  for (const char* region : {"0,0,0,0,1,1", "0,0,0,1,1,1000", "0,0,0,1,1", "0,0,0.5,1,1,1", "-1,0,0,1,1,1"}) {
    const Run wrong = convert_file(scene.asset, path, {"--region", region});
    INFO(region << wrong.err);
    CHECK(wrong.exit == 2);
    CHECK(wrong.messages() == 1);
  }
}

TEST_CASE("instances are written, buried ones on request not") {
  const Ball scene;
  const Run all = convert_file(scene.asset, scene.folder.file("a.glb"), {"--as", "instances"});
  const Run seen =
      convert_file(scene.asset, scene.folder.file("b.glb"), {"--as", "instances", "--drop-buried"});
  INFO(all.err << seen.err);
  REQUIRE((all.exit == 0 && seen.exit == 0));
  CHECK(all.json()["instances"] == info_about(scene.asset)["instances"]["inside"]);
  CHECK(seen.json()["instances"].get<int>() + seen.json()["buried"].get<int>() == all.json()["instances"]);
  const Run twice = convert_file(scene.asset, scene.folder.file("c.glb"), {"--as", "instances"});
  CHECK(read_bytes(scene.folder.file("a.glb")) == read_bytes(scene.folder.file("c.glb")));
  CHECK(convert_file(scene.asset, scene.folder.file("c.obj"), {"--as", "instances"}).exit == 2);
}

TEST_CASE("a mesh that is kept comes out again, but for what the file says") {
  const TempFolder folder;
  const std::string asset = folder.file("a.meso"), back = folder.file("back.ply"), drc = folder.file("a.drc");
  REQUIRE(convert_file("shape:knot:size=2", asset, {"--keep-mesh", "--tiles", "6"}).exit == 0);
  CHECK(info_about(asset)["format"] == "meso 1.1");
  CHECK(run_command({"validate", asset}).exit == 0);
  const Run run = convert_file(asset, back, {"--as", "basic-mesh"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  const double error = run.json()["max_error"];
  CHECK(error > 0);
  CHECK(error < 1e-5);
  REQUIRE(convert_file(asset, drc).exit == 0);
  const auto mesh = info_about(back), same = info_about(drc);
  CHECK(mesh["diagnosis"]["closed"] == true);
  CHECK(mesh["diagnosis"]["triangles"] == run.json()["triangles"]);
  CHECK(mesh["box"] == same["box"]);
  for (std::size_t a = 0; a < 3; ++a)
    CHECK(std::abs(mesh["box"]["max"][a].get<double>() + mesh["box"]["min"][a].get<double>()) < 4 * error);
  // What has no mesh to keep, or does not hold one, says so.
  const Run none = convert_file("tile:voronoi:cells=4,resolution=8", folder.file("t.meso"), {"--keep-mesh"});
  CHECK(none.exit == 0);
  CHECK(none.err.find("--keep-mesh has no effect") != std::string::npos);
  const Run missing = convert_file(folder.file("t.meso"), back, {"--as", "basic-mesh"});
  CHECK(missing.exit == 2);
  CHECK(missing.err.find("--keep-mesh") != std::string::npos);
  // An older version does not have it.
  const std::string old = folder.file("old.meso");
  REQUIRE(convert_file(asset, old, {"--target-version", "1.0"}).exit == 0);
  CHECK(info_about(old)["format"] == "meso 1.0");
  CHECK(std::filesystem::file_size(old) + 1000 < std::filesystem::file_size(asset));
  CHECK(run_command({"validate", old}).exit == 0);
}

TEST_CASE("an asset's grids come back from a VDB of labels") {
  const Ball scene({"--color", "cells"});
  for (const char* kind : {"level-set", "fog", "colors", "labels"}) {
    const std::string vdb = scene.folder.file(std::string(kind) + ".vdb"),
                      back = scene.folder.file("back.meso");
    const Run run = convert_file(scene.asset, vdb, {"--as", kind});
    INFO(kind << run.err);
    REQUIRE(run.exit == 0);
    CHECK(run.json()["bytes"] == std::filesystem::file_size(vdb));
    const bool asset = std::string(kind) == "labels";
    const Run again = asset ? convert_file(vdb, back) : convert_file(vdb, back, kSmall);
    INFO(again.err);
    REQUIRE(again.exit == 0);
    if (!asset) continue;
    const Run compared = run_command({"compare", scene.asset, back, "--json"});
    CHECK(compared.json()["tags_differing"] == 0);
    for (const auto& part : compared.json()["differences"])
      CHECK((part == "cell_colors" || part == "metadata"));
  }
}
