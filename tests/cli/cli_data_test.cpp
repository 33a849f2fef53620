#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// What becomes of a file of the test data: it converts, with a warning that has these words, or is refused
/// with exit 3 and a message that has them.
struct Expected {
  bool converts;
  const char* words;
};

const std::map<std::string, Expected> kTable = {
    {"corrupt/corrupted_invalid_facet_vertex.off", {false, "face 0 uses vertex 100"}},
    {"corrupt/corrupted_invalid_triangle_count.stl", {false, "promises 22 triangles"}},
    {"corrupt/notANumberNormal.ascii.stl", {true, "normal"}},
    {"corrupt/truncated.ply", {false, "cut off"}},
    {"corrupt/wrongHeader.bin.stl", {true, "solid"}},
    {"defects/40509.stl", {true, "stitched"}},
    {"defects/blobby-shuffled.off", {true, "2017 triangles were turned"}},
    {"defects/chair.off", {true, ""}},
    {"defects/cube-minimal-degenerated.obj", {true, "two equal corners"}},
    {"defects/cube_40k.obj", {true, ""}},
    {"defects/degtri_sliding.off", {false, "flat"}},
    {"defects/dragon_vrip_res3.ply", {true, ""}},
    {"defects/elephant-with-holes.off", {true, "open along 1353 edges"}},
    {"defects/featuretype.STL", {true, "stitched"}},
    {"defects/moebius.obj", {false, "thickness"}},
    {"defects/nancolor.obj", {true, ""}},
    {"defects/nearby-bad.stl", {true, ""}},
    {"defects/normal-directions-bad.stl", {true, "turned"}},
    {"defects/not_convex.obj", {true, ""}},
    {"defects/openscad-nonmanifold-crash.obj", {true, ""}},
    {"defects/rot_seven_cubes.obj", {true, "oriented inward"}},
    {"defects/stratocaster.ply", {true, ""}},
    {"defects/suzanne.obj", {true, "open along 42 edges"}},
    {"defects/teapot.obj", {true, "open along 160 edges"}},
    {"defects/tetra_intersected_by_triangle.off", {true, ""}},
    {"defects/three_cylinders.obj", {true, ""}},
    {"defects/triple_vierbein.obj", {true, ""}},
    {"defects/truck.obj", {true, "stitched"}},
    {"env/KernerEnvCube.exr", {true, ""}},
    {"env/noon_grass_1k.hdr", {true, ""}},
    {"env/san_giuseppe_bridge.hdr", {true, ""}},
    {"heights/SainteHelens.dem", {false, "a USGS digital elevation model"}},
    {"heights/bigtujunga.tif", {true, ""}},
    {"heights/brickwall_albedo.png", {true, "lossy"}},
    {"heights/brickwall_height.png", {true, "lossy"}},
    {"heights/brickwall_normal.png", {true, "lossy"}},
    {"heights/dem_squared.tif", {true, ""}},
    {"heights/heightmap_16bit.exr", {true, ""}},
    {"heights/heightmap_16bit.png", {true, ""}},
    {"heights/heightmap_32bit.exr", {true, ""}},
    {"heights/mt_fuji_regular.png", {true, ""}},
    {"heights/texture_bricks_depth.jpg", {true, "lossy"}},
    {"heights/texture_bricks_normal.jpg", {true, "lossy"}},
    {"heights/toybox_height.png", {true, ""}},
    {"heights/toybox_normal.png", {true, ""}},
    {"meshes/CesiumMilkTruck.glb", {true, "open along 8 edges"}},
    {"meshes/armadillo.obj", {true, ""}},
    {"meshes/fandisk.off", {true, ""}},
    {"meshes/knot1.off", {true, ""}},
    {"meshes/knot_orig_metro.ply", {true, ""}},
    {"meshes/lucy.ply", {true, ""}},
    {"meshes/plane.obj", {true, "open along 380 edges"}},
    {"meshes/plane_diffuse.png", {true, ""}},
    {"meshes/rocker-arm.obj", {true, ""}},
    {"meshes/spot.obj", {true, ""}},
    {"meshes/spot_texture.png", {true, ""}},
    {"meshes/stanford-bunny.obj", {true, "open along 223 edges"}},
    {"textures3d/perlinvolume.dds", {true, ""}},
    {"volumes/HeadMRVolume.mhd", {true, ""}},
    {"volumes/HeadMRVolume.raw", {false, ".mhd"}},
    {"volumes/points.vdb", {false, "PointDataGrid"}},
    {"volumes/skull_2.9.inr", {true, ""}},
    {"volumes/smoke.vdb", {true, ""}},
    {"volumes/sphere.vdb", {true, ""}},
    {"volumes/torus01.vdb", {true, ""}},
};

}  // namespace

TEST_CASE("every file of the test data converts or is refused for the right reason, in one batch") {
  const auto bunny = find_data("meshes/stanford-bunny.obj");
  if (!bunny) {
    WARN("skipped: no test data");
    return;
  }
  const std::filesystem::path data = std::filesystem::path(*bunny).parent_path().parent_path();
  std::vector<std::string> inputs;
  for (const auto& [name, expected] : kTable) inputs.push_back((data / name).string());
  // None is left out of the table.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data))
    if (entry.is_regular_file() && entry.path().parent_path() != data) {
      const std::string name = std::filesystem::relative(entry.path(), data).string();
      INFO(name);
      CHECK(kTable.contains(name));
    }
  const TempFolder folder;
  std::string list;
  for (const std::string& input : inputs) list += input + "\n";
  const Run run =
      run_command({"convert", "@" + folder.write("list.txt", list), folder.file("out/"), "--keep-going",
                   "--json", "--tiles", "16", "--tile", "voronoi:cells=8,resolution=16"});
  INFO(run.err);
  CHECK(run.exit == 3);
  const nlohmann::json json = run.json();
  REQUIRE(json["files"].size() == kTable.size());
  std::size_t at = 0;
  for (const auto& [name, expected] : kTable) {
    const nlohmann::json& file = json["files"][at++];
    INFO(name << ": " << file.dump());
    CHECK(file["exit"] == (expected.converts ? 0 : 3));
    if (!expected.converts) {
      CHECK(file["message"].get<std::string>().find(expected.words) != std::string::npos);
      continue;
    }
    std::string warnings;
    if (file.contains("report"))
      for (const auto& warning : file["report"]["warnings"])
        warnings += warning["text"].get<std::string>() + "\n";
    CHECK(warnings.find(expected.words) != std::string::npos);
    CHECK(std::filesystem::exists(file["output"].get<std::string>()));
  }
}
