#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "converters/vdb/vdb_export.h"
#include "converters/vdb/vdb_file.h"
#include "format/cell_object_io.h"
#include "format/file.h"
#include "tests/cli/run_command.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"
#include "tests/support/objects.h"
#include "tests/vdb/volumes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

const std::vector<std::string> kTile = {"--tiles", "6", "--tile", "voronoi:cells=8,resolution=16,seed=1",
                                        "--json"};

Run convert(const std::string& input, const std::string& output, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"convert", input, output};
  words.insert(words.end(), kTile.begin(), kTile.end());
  words.insert(words.end(), more.begin(), more.end());
  return run_command(words);
}

CellObject load(const std::string& path) {
  const auto bytes = read_file(path, 1 << 28);
  REQUIRE(bytes);
  auto object = read_cell_object(*bytes);
  REQUIRE(object);
  return std::move(*object);
}

/// A ball, and red light everywhere.
std::string ball_file(const Folder& folder) {
  std::vector<SparseVolume> grids{ball_volume(1, 0.05), SparseVolume()};
  grids[1].name = "Cd";
  grids[1].type = VolumeType::kFloat3;
  grids[1].background = {1, 0, 0};
  const std::string path = folder / "ball.vdb";
  REQUIRE(write_vdb(path, grids));
  return path;
}

}  // namespace

TEST_CASE("volume command: a level set is filled, with the colors of another grid") {
  const Folder folder;
  const std::string vdb = ball_file(folder), out = folder / "ball.meso";
  const Run run = convert(vdb, out, {"--color", "grid"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.err.find("Cd") != std::string::npos);  // the grid that was not taken
  const double inside = run.json()["volume"]["inside"].get<double>();
  CHECK(inside < 4.0 / 3 * M_PI);
  CHECK(inside > 1);
  const CellObject object = load(out);
  REQUIRE(object.instance_colors);
  for (const Rgb8& color : object.instance_colors->colors) CHECK(color == Rgb8{255, 0, 0});
  CHECK(object.metadata[1] ==
        std::pair<std::string, std::string>("source", "volume:file=ball.vdb,grid=ball,iso=0"));
  REQUIRE(
      convert(vdb, folder / "b.meso", {"--grid", "ball", "--iso", "-0.1", "--color", "volume:file=" + vdb})
          .exit == 0);
  CHECK(inside_volume(load(folder / "b.meso")) < inside);
}

TEST_CASE("volume command: grids that were not taken are losses") {
  const Folder folder;
  const std::string vdb = ball_file(folder), out = folder / "ball.meso";
  const auto losses = [&](const std::vector<std::string>& more) {
    const Run run = convert(vdb, out, more);
    INFO(run.err);
    REQUIRE(run.exit == 0);
    return run.json()["losses"];
  };
  CHECK(losses({}) == nlohmann::json{"grid Cd"});
  CHECK(losses({"--grid", "ball", "--color", "wood"}) == nlohmann::json{"grid Cd"});
  CHECK(losses({"--color", "grid"}).empty());
  CHECK(losses({"--color", "volume:file=" + vdb}).empty());
  CHECK(losses({"--color", "volume:grid=Cd,file=" + vdb}).empty());
}

TEST_CASE("volume command: info lists grids") {
  const Folder folder;
  const Run run = run_command({"info", ball_file(folder), "--json"});
  REQUIRE(run.exit == 0);
  CHECK(run.json()["format"] == "VDB");
  CHECK(run.json()["grids"].size() == 2);
  CHECK(run.json()["grids"][0]["name"] == "ball");
  CHECK(run.json()["grids"][0]["class"] == "level set");
  CHECK(run.json()["grids"][0]["active_voxels"].get<int>() > 1000);
}

TEST_CASE("volume command: labels become the asset that they were, or a tile") {
  const Folder folder;
  Rng rng(1);
  const CellObject object = random_object(rng, "voronoi:cells=12,resolution=10,seed=5", {3, 2, 2}, 0.5);
  VdbExportOptions options;
  options.kinds.labels = true;
  REQUIRE(export_vdb(object, folder / "labels.vdb", options));
  const Run run = run_command({"convert", folder / "labels.vdb", folder / "back.meso"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  const CellObject back = load(folder / "back.meso");
  CHECK((back.grid == object.grid));
  CHECK((back.tile == object.tile));
  CHECK((back.membership == object.membership));
  const Run tile = run_command(
      {"convert", "tile:labels:file=" + (folder / "labels.vdb") + ",grid=tile", folder / "tile.meso"});
  INFO(tile.err);
  REQUIRE(tile.exit == 0);
  CHECK(load(folder / "tile.meso").tile.resolution == object.tile.resolution);
}

TEST_CASE("volume command: wrong words and wrong files are told apart") {
  const Folder folder;
  const std::string vdb = ball_file(folder), out = folder / "a.meso";
  CHECK(convert(vdb, out, {"--grid", "none"}).exit == 2);
  CHECK(convert(vdb, out, {"--grid", "Cd"}).exit == 3);
  CHECK(convert(vdb, out, {"--iso", "9"}).exit == 3);
  std::ofstream(folder / "no.vdb") << "nothing";
  CHECK(convert(folder / "no.vdb", out).exit == 3);
  std::ofstream(folder / "no.mhd") << "NDims = 3\n";
  CHECK(convert(folder / "no.mhd", out).exit == 3);
}
