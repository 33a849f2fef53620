#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

constexpr const char* kAnyTile = "voronoi:cells=4,resolution=8,seed=1";

std::vector<std::string> conversion(const std::string& input, const std::string& output,
                                    std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"convert", input, output};
  words.insert(words.end(), more.begin(), more.end());
  const auto add = [&](const char* option, const char* value) {
    if (std::find(more.begin(), more.end(), option) == more.end()) words.insert(words.end(), {option, value});
  };
  add("--tiles", "4");
  add("--tile", kAnyTile);
  return words;
}

/// Runs a conversion that must fail: with this exit code, one message that names the file and a remedy, and
/// nothing left behind.
void check_refused(const TempFolder& folder, const std::string& input, int code,
                   std::vector<std::string> more = {}) {
  INFO(input << " " << (more.empty() ? "" : more.back()));
  const std::vector<std::string> before = folder.list();
  const Run run = run_command(conversion(input, folder.file("out.meso"), more));
  INFO(run.err);
  CHECK(run.exit == code);
  CHECK(run.messages() == 1);
  CHECK(run.err.starts_with("mesocell: "));
  if (more.empty()) CHECK(run.err.find(input) != std::string::npos);
  if (code != 2) CHECK(run.err.find("; ") != std::string::npos);  // usage errors tell what is allowed
  CHECK(run.out.empty());
  CHECK(folder.list() == before);
}

std::string off(const TriangleMesh& mesh) { return mesh_bytes(mesh, "mesh.off"); }

TriangleMesh scaled_box(double s) { return make_box({-s, -s, -s}, {s, s, s}); }

}  // namespace

TEST_CASE("what cannot be read as a mesh ends with 3") {
  const TempFolder folder;
  check_refused(folder, folder.file("missing.obj"), 3);
  REQUIRE(mkdir(folder.file("folder.obj").c_str(), 0700) == 0);
  check_refused(folder, folder.file("folder.obj"), 3);
  check_refused(folder, folder.write("empty.ply", ""), 3);
  check_refused(folder, folder.write("letter.obj", "Dear Sir or Madam,\n"), 3);
  check_refused(folder, folder.write("image.stl", "\x89PNG\r\n\x1a\n"), 3);
  check_refused(folder, folder.write("scene.glb", "glTF"), 3);
  check_refused(folder, folder.write("cut.off", off(scaled_box(1)).substr(0, 150)), 3);
  check_refused(folder, folder.write("counts.off", "OFF\n4000000000 4000000000 0\n"), 3);
  check_refused(folder, folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), 3);
  check_refused(folder, folder.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), 3);
  for (const char* bad : {"nan", "inf", "-inf"})
    check_refused(
        folder, folder.write("number.obj", std::string("v 0 0 ") + bad + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), 3);
}

TEST_CASE("an input without permission ends with 3") {
  if (geteuid() == 0) {
    WARN("skipped: root may read everything");
    return;
  }
  const TempFolder folder;
  const std::string path = folder.write("secret.off", off(scaled_box(1)));
  REQUIRE(chmod(path.c_str(), 0) == 0);
  check_refused(folder, path, 3);
}

TEST_CASE("a mesh that encloses nothing or is open ends with 3") {
  const TempFolder folder;
  check_refused(folder, folder.write("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), 3);
  check_refused(folder, folder.write("plane.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), 3);
  check_refused(folder, folder.write("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), 3);
  TriangleMesh open = make_sphere({0, 0, 0}, 1, 8);
  open.triangles.pop_back();
  check_refused(folder, folder.write("open.off", off(open)), 3, {"--repair", "strict"});
  // A plane with both its sides is closed and still has no inside.
  check_refused(folder, folder.write("leaf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n"), 3);
}

TEST_CASE("very large and very small closed meshes work or end with 3 and a reason") {
  const TempFolder folder;
  for (const double scale : {1e30, 1e-30, 1e200, 1e-300, 1e308}) {
    INFO(scale);
    const Run run =
        run_command(conversion(folder.write("box.off", off(scaled_box(scale))), folder.file("o.meso")));
    INFO(run.err);
    CHECK((run.exit == 0 || run.exit == 3));
    const bool warned = run.err.find(": warning: ") != std::string::npos;
    CHECK((run.exit == 0) == (run.err.empty() || warned));
    if (run.exit == 0) CHECK(run_command({"validate", folder.file("o.meso")}).exit == 0);
  }
}

TEST_CASE("options that make no sense end with 2, limits with 5") {
  const TempFolder folder;
  const std::string box = folder.write("box.off", off(scaled_box(1)));
  for (const char* tile : {"voronoi:resolution=0", "voronoi:cells=0", "marble", "voronoi:cells=8,", ""})
    check_refused(folder, box, 2, {"--tile", tile});
  for (const char* tiles : {"0", "-1", "2.5", "many"}) check_refused(folder, box, 2, {"--tiles", tiles});
  for (const char* rule : {"center", "", "centre,conservative"})
    check_refused(folder, box, 2, {"--rule", rule});
  for (const char* color :
       {"", "mauve", "marble:resolution=0", "marble:hue=3", "cells:resolution=8", "wood:"})
    check_refused(folder, box, 2, {"--color", color});
  check_refused(folder, box, 5, {"--tiles", "1000000"});
  check_refused(folder, box, 5, {"--tiles", "99999999999"});
  for (const char* box_text :
       {"0,0,0,1,1", "0,0,0,1,1,nan", "1,1,1,0,0,0", "0,0,0,0,1,1", "0,0,0,1,1,1,", "x"})
    check_refused(folder, box, 2, {"--box", box_text});
  for (const char* threads : {"-1", "many", "99999"}) check_refused(folder, box, 2, {"--threads", threads});
  check_refused(folder, box, 2, {"--no-such-option"});
  for (const char* size : {"0", "-1", "nan", "inf"}) {
    const Run run =
        run_command({"convert", box, folder.file("out.meso"), "--tile", kAnyTile, "--tile-size", size});
    INFO(size << run.err);
    CHECK(run.exit == 2);
  }
  CHECK(folder.list() == std::vector<std::string>{"box.off"});
}

TEST_CASE("an output that cannot be written ends with 4 before the work begins") {
  const TempFolder folder;
  // With an input that would take long, so that a late check would show.
  const std::string mesh = folder.write("torus.off", off(make_torus({0, 0, 0}, 1, 0.5, 200, 100)));
  REQUIRE(mkdir(folder.file("folder.meso").c_str(), 0700) == 0);
  for (const std::string& output :
       {folder.file("missing/out.meso"), folder.file("folder.meso"), mesh + "/x.meso"}) {
    INFO(output);
    const std::vector<std::string> before = folder.list();
    const Run run = run_command(
        {"convert", mesh, output, "--tiles", "512", "--tile", "voronoi:cells=1000,resolution=512"});
    CHECK(run.exit == 4);
    CHECK(run.messages() == 1);
    CHECK(run.err.find(output) != std::string::npos);
    CHECK(folder.list() == before);
  }
}

TEST_CASE("a failure leaves the old output whole") {
  const TempFolder folder;
  const std::string old = folder.write("out.meso", "the old file");
  TriangleMesh open = make_sphere({0, 0, 0}, 1, 8);
  open.triangles.pop_back();
  CHECK(run_command(conversion(folder.write("open.off", off(open)), old, {"--repair", "strict"})).exit == 3);
  CHECK(read_bytes(old) == "the old file");
  CHECK(run_command(conversion(folder.write("box.off", off(scaled_box(1))), old, {"--no-clobber"})).exit ==
        4);
  CHECK(read_bytes(old) == "the old file");
  CHECK(run_command(conversion(folder.file("box.off"), old)).exit == 0);
  CHECK(read_bytes(old) != "the old file");
  CHECK(folder.list() == std::vector<std::string>{"box.off", "open.off", "out.meso"});
}

TEST_CASE("a name with control characters is shown, not obeyed") {
  const TempFolder folder;
  const Run run = run_command(conversion(folder.file("a\x1b[2Jb\nc.obj"), folder.file("o.meso")));
  CHECK(run.exit == 3);
  CHECK(run.err.find('\x1b') == std::string::npos);
  CHECK(run.messages() == 1);
}

TEST_CASE("with --json a failure is an object too") {
  const TempFolder folder;
  const Run run = run_command(conversion(folder.file("missing.obj"), folder.file("o.meso"), {"--json"}));
  CHECK(run.exit == 3);
  CHECK(run.messages() == 1);
  const nlohmann::json error = run.json()["error"];
  CHECK(error["code"] == "unreadable");
  CHECK(error["exit"] == 3);
  CHECK(error["file"] == folder.file("missing.obj"));
  CHECK(error["message"].is_string());
  CHECK(error["id"].is_string());
  CHECK(run_command({"convert", "--json", "--bogus"}).json()["error"]["exit"] == 2);
}
