#include <filesystem>
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

/// Three stones in a tile of 1 m, one of which sticks out of it.
std::string stones(const TempFolder& folder) {
  TriangleMesh mesh = make_sphere({0.3, 0.3, 0.3}, 0.2, 12);
  append(mesh, make_box({0.6, 0.6, 0.6}, {0.8, 0.9, 0.8}));
  append(mesh, make_sphere({1, 0.3, 0.8}, 0.15, 12));
  return folder.write("stones.obj", mesh_bytes(mesh, "mesh.obj"));
}

std::string mesh_tile(const std::string& file, const std::string& more = "") {
  return "mesh:file=" + file + ",size=1,origin=0x0x0,resolution=32" + more;
}

json convert_tile(const std::vector<std::string>& words, int exit = 0) {
  std::vector<std::string> all = {"convert", "--json"};
  all.insert(all.end(), words.begin(), words.end());
  const Run run = run_command(all);
  CAPTURE(run.err);
  REQUIRE(run.exit == exit);
  return run.json();
}

std::vector<std::string> warning_ids(const json& result) {
  std::vector<std::string> ids;
  for (const json& warning : result["warnings"]) ids.push_back(warning["id"]);
  return ids;
}

}  // namespace

TEST_CASE("a tile is made, kept, shown and used by another asset") {
  const TempFolder folder;
  const std::string tile = folder.file("stones.meso"), asset = folder.file("ball.meso");
  const json kept =
      convert_tile({"tile:" + mesh_tile(stones(folder)), tile, "--color", "cells:seed=2", "--normals"});
  CHECK(kept["cells"] == 3);
  CHECK(kept["instances"]["inside"] == 3);
  CHECK(kept["tiles"] == json({2, 1, 1}));
  CHECK(kept["object_box"]["min"] == json({0, 0, 0}));
  CHECK(kept["normals"] > 0);
  CHECK(kept["metadata"]["tile"] == "mesh:file=stones.obj,origin=0x0x0,resolution=32,size=1");
  CHECK(kept["warnings"].empty());
  CHECK(run_command({"validate", tile}).exit == 0);
  CHECK(run_command({"render", tile, folder.file("tile.png"), "--size", "40x30"}).exit == 0);

  const std::string ball = folder.write("ball.off", mesh_bytes(make_sphere({0, 0, 0}, 4, 20), "mesh.off"));
  const json used = convert_tile({ball, asset, "--tiles", "8", "--tile", tile});
  CHECK(used["cells"] == 3);
  CHECK(used["cell_colors"] == 3);
  CHECK(used["normals"] == kept["normals"]);
  CHECK(used["metadata"] == kept["metadata"]);
  CHECK(used["instances"]["inside"] > 100);
  // Colors of one's own replace those that came with the tile.
  const json recolored =
      convert_tile({ball, folder.file("marble.meso"), "--tile", tile, "--color", "marble:resolution=8"});
  CHECK(recolored["cell_colors"] == 0);
  CHECK(recolored["color_resolution"] == json({8, 8, 8}));
  CHECK(recolored["metadata"]["color"] == "marble:resolution=8");
  // The same tile, directly.
  convert_tile(
      {ball, folder.file("direct.meso"), "--tiles", "8", "--tile", mesh_tile(folder.file("stones.obj"))});
  const Run compared = run_command({"compare", asset, folder.file("direct.meso"), "--json"});
  CHECK(compared.json()["tags_differing"] == 0);
  CHECK(compared.json()["voxels_differing"] == 0);
  CHECK(convert_tile({ball, tile, "--tile", tile}, 2)["error"]["message"] ==
        "input and output are the same file; name another output");
}

TEST_CASE("generated tiles can be shown too, and options of a grid do nothing there") {
  const TempFolder folder;
  const json tile = convert_tile({"tile:voronoi:cells=5,resolution=16", folder.file("v.meso"), "--tiles", "4",
                                  "--tile-size", "1", "--box", "0,0,0,1,1,1"},
                                 2);
  const json warned =
      convert_tile({"tile:voronoi:cells=5,resolution=16", folder.file("v.meso"), "--tiles", "4", "--box",
                    "0,0,0,1,1,1", "--rule", "centre", "--tile", "spheres", "--percolating", "cut"});
  CHECK(warned["instances"]["inside"] == 5);
  CHECK(warning_ids(warned) == std::vector<std::string>(5, "option-unused"));
  CHECK(warned["volume"]["mesh"] == 0);
}

TEST_CASE("what is odd in meshes of a tile is said") {
  const TempFolder folder;
  TriangleMesh mesh = make_box({0, 0, 0}, {0.5, 0.5, 0.5});
  append(mesh, make_box({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}));
  append(mesh, make_box({0.1, 0.1, 0.1}, {0.101, 0.101, 0.101}));
  const std::string file = folder.write("boxes.off", mesh_bytes(mesh, "mesh.off"));
  const json made = convert_tile({"tile:" + mesh_tile(file), folder.file("t.meso")});
  CHECK(made["cells"] == 2);
  CHECK(warning_ids(made) == std::vector<std::string>{"cells-dropped", "cells-overlap"});
  // All of the file as one cell: overlapping parts are united.
  CHECK(convert_tile({"tile:" + mesh_tile(file, ",cells=file"), folder.file("t.meso")})["cells"] == 1);
}

TEST_CASE("labels become a tile: a folder of slices, pages of a TIFF, a raw file") {
  const TempFolder folder;
  // Two cells: a box, and a plate that goes around the tile along x and so meets its own copy.
  constexpr std::uint32_t n = 8;
  std::string raw;
  std::vector<PlainPicture> slices;
  for (std::uint32_t z = 0; z < n; ++z) {
    PlainPicture slice{n, n, 1, std::vector<std::uint32_t>(n * n)};
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t label = z == 6 && y < 5 ? 9 : z < 4 && x < 3 && y < 4 ? 200 : 0;
        raw += char(label);
        slice.samples[x + n * (n - 1 - y)] = label;  // rows from the top
      }
    folder.write("slice" + std::to_string(z + 5) + ".png", png_bytes(slice));
    slices.push_back(std::move(slice));
  }
  std::filesystem::create_directory(folder.file("slices"));
  for (std::uint32_t z = 0; z < n; ++z)
    std::filesystem::rename(folder.file("slice" + std::to_string(z + 5) + ".png"),
                            folder.file("slices/slice" + std::to_string(z + 5) + ".png"));
  const std::string tiff = folder.write("labels.tif", tiff_bytes(slices)),
                    file = folder.write("labels.raw", raw);

  const json a = convert_tile({"tile:labels:file=" + folder.file("slices") + "/", folder.file("a.meso")});
  CHECK(a["cells"] == 2);
  CHECK(a["tile_resolution"] == json({8, 8, 8}));
  CHECK(a["metadata"]["tile"] == "labels:file=slices");
  CHECK(warning_ids(a) == std::vector<std::string>{"tile-percolates"});
  convert_tile({"tile:labels:file=" + tiff, folder.file("b.meso")});
  convert_tile({"tile:labels:resolution=8,file=" + file, folder.file("c.meso")});
  for (const char* other : {"b.meso", "c.meso"}) {
    const json compared =
        run_command({"compare", folder.file("a.meso"), folder.file(other), "--json"}).json();
    CHECK(compared["differences"] == json({"metadata"}));
  }
  const json refused =
      convert_tile({"tile:labels:file=" + tiff, folder.file("d.meso"), "--percolating", "refuse"}, 3);
  CHECK(refused["error"]["id"] == "tile-percolates");
  CHECK(refused["error"]["message"].get<std::string>().find("label 9") != std::string::npos);
  convert_tile({"tile:labels:file=" + file, folder.file("d.meso")}, 2);
  convert_tile({"tile:labels:file=" + file + ",resolution=9", folder.file("d.meso")}, 3);
  convert_tile({"tile:labels:file=" + tiff, folder.file("d.meso"), "--percolating", "perhaps"}, 2);
}

TEST_CASE("a picture becomes a solid texture, with a warning where it has a seam") {
  const TempFolder folder;
  PlainPicture stripes{8, 4, 3, {}}, ramp{8, 4, 3, {}};
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < 8; ++x)
      for (std::uint32_t c = 0; c < 3; ++c) {
        stripes.samples.push_back(x % 2 ? 200 : 40);
        ramp.samples.push_back(30 * x);
      }
  const std::string tile = "tile:voronoi:cells=3,resolution=8";
  const json plain = convert_tile({tile, folder.file("s.meso"), "--color",
                                   "image:file=" + folder.write("stripes.png", png_bytes(stripes))});
  CHECK(plain["color_resolution"] == json({8, 4, 1}));
  CHECK(plain["metadata"]["color"] == "image:file=stripes.png");
  CHECK(plain["warnings"].empty());
  const std::string file = folder.write("ramp.png", png_bytes(ramp));
  CHECK(warning_ids(convert_tile({tile, folder.file("r.meso"), "--color", "image:file=" + file})) ==
        std::vector<std::string>{"color-seam"});
  convert_tile({tile, folder.file("r.meso"), "--color", "image"}, 2);
  convert_tile({tile, folder.file("r.meso"), "--color", "image:seed=3,file=" + file}, 2);
  convert_tile({tile, folder.file("r.meso"), "--color", "image:file=" + folder.file("none.png")}, 3);
}

TEST_CASE("a tile that cannot be made is refused with the right exit code") {
  const TempFolder folder;
  const std::string out = folder.file("o.meso"), file = stones(folder);
  const auto refused = [&](const std::string& tile, int exit) {
    CAPTURE(tile);
    const Run run = run_command({"convert", "tile:" + tile, out});
    CHECK(run.exit == exit);
    CHECK(run.messages() == 1);
    return run.err;
  };
  CHECK(refused("foam", 2).find(
            "voronoi, spheres, ellipsoids, worley, bricks, mesh, labels, heights, and files .meso") !=
        std::string::npos);
  refused("mesh:resolution=16", 2);
  refused(mesh_tile(file, ",cells=3"), 2);
  refused("mesh:file=" + file + ",size=-1", 2);
  refused("mesh:file=" + file + ",origin=0x0", 2);
  refused("mesh:file=" + file + ",origin=0x0xnan", 2);
  refused("mesh:file=" + file + ",resolution=2", 2);
  refused("mesh:file=" + file + ",seed=2", 2);
  refused("mesh:file=" + folder.file("none.obj"), 3);
  refused("mesh:file=" + file + ",size=1e-6", 5);
  refused("mesh:file=" + file + ",size=1e9", 3);
  refused(folder.file("none.meso"), 3);
  refused(folder.write("bad.meso", "this is no asset"), 3);
  TriangleMesh open = make_box({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  CHECK(refused("mesh:file=" + folder.write("open.off", mesh_bytes(open, "mesh.off")), 3).find("open.off") !=
        std::string::npos);
}
