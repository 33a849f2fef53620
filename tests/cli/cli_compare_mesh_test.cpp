#include <cmath>
#include <csignal>
#include <string>
#include <vector>

#include "tests/cli/picture_scene.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

/// The mesh that a scene's asset is made of.
std::string mesh_of(const Scene& scene) { return scene.folder.file("ball.off"); }

/// Runs compare with --json and checks what holds for every result.
json compare_mesh(const std::string& asset, const std::string& mesh, int exit,
                  const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"compare", asset, mesh, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const Run run = run_command(words);
  INFO(run.err);
  CHECK(run.exit == exit);
  CHECK(run.err.empty());
  json result = run.json();
  CHECK(result["kind"] == "asset-and-mesh");
  CHECK(result["equal"] == (exit == 0));
  CHECK(result["differences"] == (exit == 0 ? json::array() : json({"surface"})));
  // The help text has the keys that scripts may rely on.
  static const std::string help = run_command({"compare", "--help"}).out;
  const json flat = result.flatten();
  for (const auto& [path, value] : flat.items())
    CHECK(help.find(path.substr(path.rfind('/') + 1)) != std::string::npos);
  const json& distance = result["surface_distance"];
  for (const char* direction : {"asset_to_mesh", "mesh_to_asset"}) {
    const json& d = distance[direction];
    CHECK(help.find(direction) != std::string::npos);
    CHECK(d["samples"] == distance["samples"]);
    CHECK((d["mean"] > 0.0 && d["rms"] >= d["mean"] && d["max"] >= d["rms"]));
    for (const std::string name : {"max", "mean", "rms"})
      CHECK(d[name + "_percent"].get<double>() ==
            Approx(100 * d[name].get<double>() / distance["diagonal"].get<double>()));
  }
  return result;
}

std::string number(double x) { return std::to_string(x); }

}  // namespace

TEST_CASE("an asset and its mesh have distances and a volume") {
  const Scene scene;
  const json result = compare_mesh(scene.asset, mesh_of(scene), 0);
  const json& distance = result["surface_distance"];
  CHECK(result["tolerance"].is_null());
  CHECK(distance["samples"] == 100000);
  CHECK(distance["seed"] == 1);
  CHECK(distance["diagonal"].get<double>() == Approx(2 * std::sqrt(3)).epsilon(1e-3));
  // Cells of the ball's eight tiles are an eighth of its width, and those at the border are missing.
  CHECK(distance["mesh_to_asset"]["max"] < 0.6);
  CHECK(distance["asset_to_mesh"]["max"] < 0.6);
  CHECK(distance["asset_to_mesh"]["mean"] > 0.02);
  const json& volume = result["volume"];
  CHECK(volume["mesh"].get<double>() == Approx(4.18879).epsilon(2e-2));
  CHECK(volume["percent"].get<double>() ==
        Approx(100 * volume["asset"].get<double>() / volume["mesh"].get<double>()));
  const json made = run_command({"convert", mesh_of(scene), scene.folder.file("again.meso"), "--tiles", "8",
                                 "--tile", "voronoi:cells=8,resolution=16,seed=1", "--json"})
                        .json();
  CHECK(volume["asset"] == made["volume"]["inside"]);
  CHECK(volume["mesh"] == made["volume"]["mesh"]);
  // Smaller cells are nearer.
  const Scene finer({"--tiles", "16"});
  const json near = compare_mesh(finer.asset, mesh_of(finer), 0, {"--samples", "5000"});
  for (const char* direction : {"asset_to_mesh", "mesh_to_asset"})
    CHECK(near["surface_distance"][direction]["rms"] < distance[direction]["rms"]);
}

TEST_CASE("the tolerance is for the greater RMS distance, in per cent") {
  const Scene scene;
  const std::vector<std::string> few = {"--samples", "2000"};
  const json result = compare_mesh(scene.asset, mesh_of(scene), 0, few)["surface_distance"];
  const double rms = std::max(result["asset_to_mesh"]["rms_percent"].get<double>(),
                              result["mesh_to_asset"]["rms_percent"].get<double>());
  CHECK(rms > 1);
  const auto with = [&](double tolerance) {
    return std::vector<std::string>{"--samples", "2000", "--tolerance", number(tolerance)};
  };
  CHECK(compare_mesh(scene.asset, mesh_of(scene), 0, with(rms + 1e-3))["tolerance"] == Approx(rms + 1e-3));
  compare_mesh(scene.asset, mesh_of(scene), 1, with(rms - 1e-3));
  compare_mesh(scene.asset, mesh_of(scene), 1, with(0));
  const auto text = [&](const char* tolerance, bool quiet) {
    std::vector<std::string> words = {"compare", scene.asset,   mesh_of(scene), "--samples",
                                      "2000",    "--tolerance", tolerance};
    if (quiet) words.push_back("--quiet");
    return run_command(words);
  };
  CHECK(text("0.5", false).exit == 1);
  CHECK(text("0.5", false).out.find("over the tolerance of 0.5 %") != std::string::npos);
  CHECK(text("50", false).out.find("within the tolerance of 50 %") != std::string::npos);
  CHECK(text("50", false).out.find("mesh to asset: max") != std::string::npos);
  CHECK(text("0.5", true).exit == 1);
  CHECK(text("50", true).exit == 0);
  CHECK(text("50", true).out.empty());
}

TEST_CASE("figures depend on the seed and not on threads") {
  const Scene scene;
  const auto with = [&](const char* seed, const char* threads) {
    return compare_mesh(scene.asset, mesh_of(scene), 0,
                        {"--samples", "3001", "--seed", seed, "--threads", threads});
  };
  const json one = with("18446744073709551615", "1");
  CHECK(one["surface_distance"]["seed"] == 18446744073709551615u);
  CHECK(one["surface_distance"]["samples"] == 3001);
  CHECK(one == with("18446744073709551615", "3"));
  CHECK(one["surface_distance"]["asset_to_mesh"] != with("2", "3")["surface_distance"]["asset_to_mesh"]);
}

TEST_CASE("an open mesh has distances and no volume") {
  const Scene scene;
  TriangleMesh open = make_sphere({0, 0, 0}, 1, 24);
  open.triangles.resize(open.triangles.size() / 2);
  const std::string mesh = scene.folder.write("open.ply", mesh_bytes(open, "little.ply"));
  const json result = compare_mesh(scene.asset, mesh, 0, {"--samples", "2000"});
  CHECK(result["volume"]["asset"] > 1.0);
  CHECK(result["volume"]["mesh"].is_null());
  CHECK(result["volume"]["percent"].is_null());
}

TEST_CASE("what cannot be read or measured is 3, with one message") {
  const Scene scene;
  const std::string mesh = mesh_of(scene), bytes = read_bytes(mesh);
  const auto error = [&](const std::string& asset, const std::string& with) {
    const Run run = run_command({"compare", asset, with, "--json"});
    INFO(run.err);
    CHECK(run.exit == 3);
    CHECK(run.messages() == 1);
    CHECK(run.json().contains("error"));
    return run.err;
  };
  CHECK(error(scene.folder.file("missing.meso"), mesh).find("missing.meso") != std::string::npos);
  CHECK(error(scene.asset, scene.folder.file("missing.off")).find("missing.off") != std::string::npos);
  error(scene.asset, scene.folder.write("cut.off", bytes.substr(0, bytes.size() / 2)));
  const std::string asset_bytes = read_bytes(scene.asset);
  error(scene.folder.write("cut.meso", asset_bytes.substr(0, asset_bytes.size() / 2)), mesh);
  const std::string flat = "OFF\n3 1 0\n0 0 0\n1 1 1\n2 2 2\n3 0 1 2\n";
  CHECK(error(scene.asset, scene.folder.write("flat.off", flat)).find("no area") != std::string::npos);
  const TriangleMesh far = make_box({0, 0, 0}, {1e30, 1, 1});
  error(scene.asset, scene.folder.write("far.off", mesh_bytes(far, "mesh.off")));
  const Scene coarse({"--tiles", "1", "--tile", "voronoi:cells=1,resolution=8"});
  CHECK(error(coarse.asset, mesh).find("no cell is inside") != std::string::npos);
}

TEST_CASE("samples and seeds are for an asset and a mesh") {
  const Scene scene;
  const Run run =
      run_command({"compare", scene.asset, scene.asset, "--samples", "5", "--seed", "2", "--tolerance", "7"});
  CHECK(run.exit == 0);
  CHECK(run.messages() == 3);
}

TEST_CASE("an interrupted comparison ends with 130") {
  const Scene scene;
  RunOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(700);
  const Run run = run_command({"compare", scene.asset, mesh_of(scene), "--samples", "1000000000"}, options);
  CHECK(run.exit == 130);
  CHECK(run.messages() == 1);
  CHECK(run.out.empty());
}
