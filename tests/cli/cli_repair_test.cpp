#include <chrono>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

constexpr const char* kRepairTile = "voronoi:cells=8,resolution=8,seed=1";

struct Repairs {
  TempFolder folder;

  Run convert(const std::string& input, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"convert", input,    folder.file("o.meso"), "--tiles",
                                   "8",       "--tile", kRepairTile,           "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  std::string write(const char* name, const TriangleMesh& mesh) const {
    return folder.write(name, mesh_bytes(mesh, "mesh.off"));
  }
};

TriangleMesh sheet() { return {{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0}, {0, 1, 0.2}}, {{0, 1, 2}, {0, 2, 3}}}; }

/// A sphere with a crack along its equator.
TriangleMesh cracked_sphere(double gap) {
  const TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 16);
  TriangleMesh mesh = sphere, lower = sphere;
  const auto above = [&](const Triangle& t) {
    return sphere.vertices[t[0]].z + sphere.vertices[t[1]].z + sphere.vertices[t[2]].z > 0;
  };
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return !above(t); });
  std::erase_if(lower.triangles, above);
  for (Vec3& v : lower.vertices) v.z -= gap;
  append(mesh, lower);
  return mesh;
}

std::vector<std::string> ids(const json& list) {
  std::vector<std::string> found;
  for (const json& item : list) found.push_back(item["id"]);
  return found;
}

bool has(const std::vector<std::string>& list, const char* name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

TEST_CASE("cracks are stitched, and how wide they may be can be said") {
  const Repairs r;
  json result = r.convert(r.write("fine.off", cracked_sphere(1e-6))).json();
  CHECK(result["repair"]["rung"] == "orient");
  CHECK(result["repair"]["stitched_edges"] > 10);
  CHECK(result["repair"]["largest_move"].get<double>() == Approx(1e-6));
  CHECK(result["metadata"]["repair"].get<std::string>().starts_with("orient, 0 voxels unsure, "));
  CHECK(has(ids(result["warnings"]), "mesh-stitched"));
  CHECK(has(ids(result["diagnosis"]["findings"]), "boundary-edges"));
  CHECK(result["diagnosis"]["closed"] == false);
  const std::string wide = r.write("wide.off", cracked_sphere(1e-3));
  CHECK(r.convert(wide, {"--repair", "orient"}).exit == 3);
  CHECK(r.convert(wide, {"--repair", "orient", "--stitch", "0.002"}).exit == 0);
}

TEST_CASE("a sheet is refused with a remedy, and given a thickness it is a solid") {
  const Repairs r;
  const std::string path = r.write("sheet.off", sheet());
  const Run refused = r.convert(path);
  CHECK(refused.exit == 3);
  CHECK(refused.json()["error"]["id"] == "mesh-bounds-nothing");
  CHECK(refused.json()["diagnosis"]["findings"][0]["id"] == "boundary-edges");
  CHECK(refused.json()["diagnosis"]["findings"][0]["count"] == 4);
  CHECK(refused.json()["diagnosis"]["findings"][0]["example"].size() == 3);
  CHECK(refused.err.find("thicken") != std::string::npos);
  const Run thick = r.convert(path, {"--thicken", "0.4"});
  REQUIRE(thick.exit == 0);
  CHECK(thick.json()["repair"]["rung"] == "thicken");
  CHECK(thick.json()["repair"]["thickness"] == 0.4);
  CHECK(thick.json()["instances"]["inside"] > 100);
  CHECK(thick.json()["volume"]["mesh"] == 0);
  CHECK(thick.err.find("4 boundary edges, the first near") != std::string::npos);
  const json closed =
      r.convert(r.write("ball.off", make_sphere({0, 0, 0}, 1, 12)), {"--thicken", "0.4"}).json();
  CHECK(ids(closed["warnings"]) == std::vector<std::string>{"option-unused"});
  CHECK_FALSE(closed["metadata"].contains("repair"));
}

TEST_CASE("options of repair that cannot be are refused as usage") {
  const Repairs r;
  const std::string path = r.write("sheet.off", sheet());
  for (const char* option : {"--thicken", "--stitch", "--wrap-alpha", "--wrap-offset"})
    for (const char* value : {"0", "-1", "nan", "inf"})
      CHECK(r.convert(path, {std::string(option) + "=" + value}).exit == 2);
  CHECK(r.convert(path, {"--thicken", "0.4", "--repair", "strict"}).exit == 2);
  CHECK(r.convert(path, {"--thicken", "0.4", "--repair", "wrap"}).exit == 2);
  CHECK(r.convert(path, {"--thicken", "0.4", "--rule", "conservative"}).exit == 2);
  const Run unused = r.convert(r.write("ball.off", make_sphere({0, 0, 0}, 1, 12)),
                               {"--repair", "strict", "--wrap-alpha", "1", "--stitch", "1"});
  CHECK(unused.exit == 0);
  CHECK(unused.json()["warnings"].size() == 2);
}

TEST_CASE("info tells what is amiss with a mesh") {
  const Repairs r;
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 12);
  mesh.triangles.pop_back();
  append(mesh, make_box({0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}));
  const std::string path = r.write("mesh.off", mesh);
  const Run run = run_command({"info", path, "--json"});
  REQUIRE(run.exit == 0);
  const json info = run.json();
  CHECK(info["format"] == "OFF");
  CHECK(info["volume"].is_null());
  CHECK(info["diagnosis"]["closed"] == false);
  CHECK(info["diagnosis"]["components"] == 2);
  CHECK(info["diagnosis"]["closed_components"] == 1);
  CHECK(ids(info["diagnosis"]["findings"]) ==
        std::vector<std::string>{"boundary-edges", "unbalanced-edges", "self-intersections"});
  const Run text = run_command({"info", path});
  CHECK(text.exit == 0);
  CHECK(text.out.find("3 boundary edges, the first near") != std::string::npos);
  CHECK(text.out.find("that intersect, the first near") != std::string::npos);
  const Run sound = run_command({"info", r.write("box.off", make_box({0, 0, 0}, {1, 2, 3})), "--json"});
  CHECK(sound.json()["volume"] == 6.0);
  CHECK(sound.json()["diagnosis"]["findings"].empty());
  CHECK(run_command({"info", r.folder.file("none.off")}).exit == 3);
}

#ifdef MESOCELL_WRAP
TEST_CASE("a wrap is made where it is asked for, and the asset says how far off it is") {
  const Repairs r;
  const std::string path = r.write("torn.off", cracked_sphere(0.1));
  const Run run = r.convert(path, {"--repair", "wrap", "--wrap-alpha", "0.3", "--wrap-offset", "0.05"});
  REQUIRE(run.exit == 0);
  const json result = run.json();
  CHECK(result["repair"]["rung"] == "wrap");
  CHECK(result["repair"]["wrap_alpha"] == 0.3);
  CHECK(result["repair"]["wrap_offset"] == 0.05);
  CHECK(result["repair"]["wrap_distance"] > 0.01);
  CHECK(result["repair"]["wrap_distance"] < 0.3);
  CHECK(result["volume"]["mesh"] > 4.2);
  CHECK(result["metadata"]["repair"].get<std::string>().find("wrap up to") != std::string::npos);
  CHECK(has(ids(result["warnings"]), "mesh-wrapped"));
}
#endif

namespace {

/// What becomes of a file by itself and given a thickness of 15 % of its longest side: the rung that decides,
/// or the id of the refusal.
struct Expected {
  const char *file, *by_itself, *thickened;
};

constexpr Expected kExpected[] = {
    {"40509.stl", "winding", "thicken"},
    {"blobby-shuffled.off", "orient", "orient"},
    {"chair.off", "mesh-bounds-nothing", "thicken"},
#ifdef MESOCELL_WRAP
    {"cube_40k.obj", "wrap", "thicken"},
#endif
    {"cube-minimal-degenerated.obj", "none", "none"},
    {"degtri_sliding.off", "mesh-flat", "thicken"},
    {"dragon_vrip_res3.ply", "none", "none"},
    {"elephant-with-holes.off", "winding", "thicken"},
    {"featuretype.STL", "orient", "orient"},
    {"moebius.obj", "mesh-bounds-nothing", "thicken"},
    {"nancolor.obj", "none", "none"},
    {"nearby-bad.stl", "winding", "thicken"},
    {"normal-directions-bad.stl", "orient", "orient"},
    {"not_convex.obj", "none", "none"},
    {"openscad-nonmanifold-crash.obj", "none", "none"},
    {"rot_seven_cubes.obj", "none", "none"},
    {"stratocaster.ply", "none", "none"},
    {"suzanne.obj", "winding", "thicken"},
    {"teapot.obj", "winding", "thicken"},
    {"tetra_intersected_by_triangle.off", "winding", "thicken"},
    {"three_cylinders.obj", "none", "none"},
#ifdef MESOCELL_WRAP
    {"triple_vierbein.obj", "mesh-bounds-nothing", "thicken"},
#endif
    {"truck.obj", "winding", "thicken"},
};

std::string outcome(const Run& run) {
  const json result = run.json();
  if (run.exit == 0) return result["repair"]["rung"];
  return result.contains("error") ? std::string(result["error"]["id"])
                                  : "ended by " + std::to_string(run.exit);
}

}  // namespace

TEST_CASE("files with every defect become solids or are refused for a reason") {
  const Repairs r;
  for (const Expected& expected : kExpected) {
    const auto path = find_data(std::string("defects/") + expected.file);
    if (!path) {
      WARN(expected.file << " is not here; skipped");
      continue;
    }
    INFO(expected.file);
    CHECK(outcome(r.convert(*path)) == expected.by_itself);
    const json box = run_command({"info", *path, "--json"}).json()["box"];
    double side = 0;
    for (std::size_t a = 0; a < 3; ++a)
      side = std::max(side, box["max"][a].get<double>() - box["min"][a].get<double>());
    CHECK(outcome(r.convert(*path, {"--thicken", std::to_string(0.15 * side)})) == expected.thickened);
  }
}

TEST_CASE("what is solid of shells in one another can be chosen, and is kept") {
  const Repairs r;
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 16);
  append(mesh, make_sphere({0, 0, 0}, 0.6, 16));
  TriangleMesh cavity = make_sphere({0, 0, 0}, 0.3, 16);
  flip(cavity);
  append(mesh, cavity);
  const std::string input = r.write("shells.off", mesh);
  const auto inside = [&](const std::vector<std::string>& more) {
    const json result = r.convert(input, more).json();
    CHECK((more.empty() || more[1] == "nonzero") == !result["metadata"].contains("solid"));
    return result["instances"]["inside"].get<int>();
  };
  const int nonzero = inside({});
  CHECK(inside({"--solid", "nonzero"}) == nonzero);
  // Twice solid in the middle, so that the cavity leaves one.
  CHECK(inside({"--solid", "outer"}) == nonzero);
  CHECK(inside({"--solid", "even-odd"}) < nonzero * 0.9);
  Run run = r.convert(input, {"--solid", "odd"});
  CHECK(run.exit == 2);
  CHECK(run.err.find("nonzero, even-odd, outer") != std::string::npos);
  run = r.convert(input, {"--solid", "even-odd", "--thicken", "0.1"});
  CHECK(run.exit == 2);
  CHECK(run.err.find("--thicken") != std::string::npos);
}
