#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

/// A folder with a torus and the asset made of it.
struct Converted {
  TempFolder folder;
  std::string asset = folder.file("torus.meso");
  Run run;

  explicit Converted(std::vector<std::string> more = {}) {
    const TriangleMesh torus = make_torus({0, 0, 0}, 1, 0.4, 32, 16);
    std::vector<std::string> words = {"convert",
                                      folder.write("torus.off", mesh_bytes(torus, "mesh.off")),
                                      asset,
                                      "--tiles",
                                      "8",
                                      "--tile",
                                      "voronoi:seed=3,cells=6,resolution=16"};
    words.insert(words.end(), more.begin(), more.end());
    run = run_command(words);
  }
};

bool three_counts(const json& value) {
  return value.is_array() && value.size() == 3 && value[0].is_number_unsigned() &&
         value[1].is_number_unsigned() && value[2].is_number_unsigned();
}

bool three_numbers(const json& value) {
  return value.is_array() && value.size() == 3 && value[0].is_number() && value[1].is_number() &&
         value[2].is_number();
}

/// What scripts rely on in `info --json` and `convert --json`.
void check_info(const json& info) {
  CHECK(info["format"] == "meso 1.0");
  CHECK(info["representation"] == "cell-object");
  CHECK(three_counts(info["tiles"]));
  CHECK(info["tiles"][0] == 8);
  CHECK(info["tile_resolution"] == json({16, 16, 16}));
  CHECK(info["cells"] == 6);
  std::uint64_t instances = 0;
  for (const char* tag : {"inside", "outside", "intersected"}) {
    REQUIRE(info["instances"][tag].is_number_unsigned());
    CHECK(info["instances"][tag] > 0);
    instances += info["instances"][tag].get<std::uint64_t>();
  }
  std::uint64_t tiles = 1;
  for (const json& n : info["tiles"]) tiles *= n.get<std::uint64_t>();
  CHECK(instances == 6 * tiles);
  CHECK(three_numbers(info["object_box"]["min"]));
  CHECK(three_numbers(info["object_box"]["max"]));
  CHECK(info["object_box"]["min"][0] < -1.4);
  CHECK(info["object_box"]["max"][0] > 1.4);
  REQUIRE(info["chunks"].is_array());
  CHECK(info["chunks"].size() == 4);
  for (const json& chunk : info["chunks"]) {
    CHECK(chunk["type"].is_string());
    CHECK(chunk["bytes"].is_number_unsigned());
    CHECK(chunk["stored"].is_number_unsigned());
    CHECK(chunk["stored"] <= chunk["bytes"]);
  }
  CHECK(info["file_bytes"].is_number_unsigned());
  CHECK(info["voxel_edge"].is_number());
  CHECK(info["rule"] == "centre");
  CHECK(info["metadata"] == json({{"tile", "voronoi:cells=6,resolution=16,seed=3"}}));
}

}  // namespace

TEST_CASE("convert --json tells all that info tells, and what it cost") {
  const Converted made({"--json"});
  INFO(made.run.err);
  REQUIRE(made.run.exit == 0);
  CHECK(made.run.err.empty());
  const json result = made.run.json();
  check_info(result);
  CHECK(result["file_bytes"] == read_bytes(made.asset).size());
  double sum = 0;
  for (const char* stage : {"read", "tile", "voxelize", "surface", "write"}) {
    REQUIRE(result["seconds"][stage].is_number());
    CHECK(result["seconds"][stage] >= 0);
    sum += result["seconds"][stage].get<double>();
  }
  CHECK(result["seconds"]["total"].get<double>() >= 0.999 * sum);
  CHECK(result["peak_bytes"] > 1'000'000);
  CHECK(result["warnings"] == json::array());
  const double volume = result["volume"]["mesh"], inside = result["volume"]["inside"];
  CHECK(volume == Approx(3.08).epsilon(0.03));  // the torus itself: 2 pi² R r²
  CHECK(inside > 0.1 * volume);
  CHECK(inside < volume);

  const Run info = run_command({"info", made.asset, "--json"});
  CHECK(info.exit == 0);
  const json told = info.json();
  check_info(told);
  for (const auto& [key, value] : told.items()) CHECK(result[key] == value);
}

TEST_CASE("a warning is told in JSON and on stderr") {
  const Converted made;
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  box.triangles.push_back({0, 0, 1});
  const std::string input = made.folder.write("box.off", mesh_bytes(box, "mesh.off"));
  const Run run = run_command({"convert", input, made.asset, "--tiles", "2", "--json"});
  CHECK(run.exit == 0);
  REQUIRE(run.json()["warnings"].size() == 1);
  CHECK(run.json()["warnings"][0]["id"] == "faces-dropped");
  CHECK(run.json()["warnings"][0]["text"].is_string());
  CHECK(run.messages() == 1);
  CHECK(run.err.find("warning") != std::string::npos);
  CHECK(run_command({"convert", input, made.asset, "--tiles", "2", "--json", "--quiet"}).err.empty());
}

TEST_CASE("the bytes do not depend on threads, the run or the mesh's format") {
  const Converted one({"--threads", "1"}), two({"--threads", "2"}), all;
  REQUIRE(one.run.exit == 0);
  const std::string bytes = read_bytes(one.asset);
  CHECK(bytes.size() > 1000);
  CHECK(read_bytes(two.asset) == bytes);
  CHECK(read_bytes(all.asset) == bytes);
  const TempFolder folder;
  const TriangleMesh torus = make_torus({0, 0, 0}, 1, 0.4, 32, 16);
  for (const char* name : {"mesh.obj", "text.ply", "big.ply"}) {
    const Run run =
        run_command({"convert", folder.write(name, mesh_bytes(torus, name)), folder.file("o.meso"), "--tiles",
                     "8", "--tile", "voronoi:cells=6,resolution=16,seed=3"});
    CHECK(run.exit == 0);
    CHECK(read_bytes(folder.file("o.meso")) == bytes);
  }
}

TEST_CASE("the grid follows --box and --tile-size") {
  const TempFolder folder;
  const std::string input = folder.write("box.off", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.off"));
  const std::string tile = "spheres:cells=3,resolution=8,seed=2";
  const Run size =
      run_command({"convert", input, folder.file("a.meso"), "--tile-size", "0.25", "--tile", tile, "--json"});
  CHECK(size.exit == 0);
  CHECK(size.json()["voxel_edge"] == Approx(0.25 / 8));
  const Run box = run_command({"convert", input, folder.file("b.meso"), "--box", "-1,-1,-1,3,1,1", "--tiles",
                               "8", "--tile", tile, "--json"});
  CHECK(box.exit == 0);
  CHECK(box.json()["tiles"][0] == 8);
  CHECK(box.json()["object_box"]["min"][0] <= -1.0);
  CHECK(box.json()["object_box"]["max"][0] >= 3.0);
  CHECK(run_command({"convert", input, folder.file("c.meso"), "--tile-size", "1", "--tiles", "4"}).exit == 2);
}

TEST_CASE("a summary for people goes to stdout, nothing with --quiet") {
  const Converted loud, quiet({"--quiet"});
  CHECK(loud.run.exit == 0);
  CHECK(loud.run.out.find(loud.asset) != std::string::npos);
  CHECK(loud.run.err.empty());
  CHECK(quiet.run.exit == 0);
  CHECK(quiet.run.out.empty());
  const Run info = run_command({"info", loud.asset});
  CHECK(info.exit == 0);
  CHECK(info.out.find("cell-object") != std::string::npos);
  CHECK(info.out.find("voronoi:cells=6,resolution=16,seed=3") != std::string::npos);
}

TEST_CASE("validate: 0 valid, 1 readable but invalid, 3 no .meso at all") {
  const Converted made;
  const Run valid = run_command({"validate", made.asset, "--json"});
  CHECK(valid.exit == 0);
  CHECK(valid.json()["valid"] == true);
  CHECK(valid.json()["issues"].is_array());

  const std::string bytes = read_bytes(made.asset);
  std::string flipped = bytes;
  flipped[bytes.size() / 2] = char(flipped[bytes.size() / 2] ^ 1);
  for (const std::string& damaged :
       {bytes.substr(0, bytes.size() / 2), bytes.substr(0, 20), flipped, bytes + "x"}) {
    const std::string path = made.folder.write("damaged.meso", damaged);
    const Run run = run_command({"validate", path, "--json"});
    CHECK(run.exit == 1);
    const json report = run.json();
    CHECK(report["valid"] == false);
    REQUIRE(!report["issues"].empty());
    for (const json& issue : report["issues"]) {
      CHECK(issue["id"].is_string());
      CHECK(issue["text"].is_string());
      CHECK((issue["severity"] == "error" || issue["severity"] == "warning" || issue["severity"] == "info"));
      CHECK((issue["offset"].is_number_unsigned() || issue["offset"].is_null()));
      CHECK((issue["chunk"].is_string() || issue["chunk"].is_null()));
    }
    CHECK(run_command({"validate", path}).exit == 1);
    CHECK(run_command({"info", path}).exit == 3);
    CHECK(run_command({"render", path, made.folder.file("p.png")}).exit == 3);
  }
  for (const std::string& other : {std::string(), bytes.substr(0, 7), std::string("OFF\n")}) {
    const std::string path = made.folder.write("other.meso", other);
    CHECK(run_command({"validate", path}).exit == 3);
    CHECK(run_command({"info", path}).exit == 3);
  }
  CHECK(run_command({"validate", made.folder.file("missing.meso")}).exit == 3);
  CHECK(run_command({"info", made.folder.path()}).exit == 3);
}
