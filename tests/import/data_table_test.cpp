#include <algorithm>
#include <string>
#include <vector>

#include "converters/import/mesh_file.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// What becomes of a file of the test data.
struct Row {
  const char* name;
  std::size_t triangles;  ///< with those that are dropped; 0: it is refused
  const char* says = "";  ///< in the refusal, or the id of a warning; none: there is no warning
};

constexpr Row kRows[] = {
    {"meshes/CesiumMilkTruck.glb", 3624},
    {"meshes/armadillo.obj", 86482},
    {"meshes/fandisk.off", 14454},
    {"meshes/knot1.off", 6400},
    {"meshes/knot_orig_metro.ply", 25600},
    {"meshes/lucy.ply", 99970},
    {"meshes/plane.obj", 2564},
    {"meshes/rocker-arm.obj", 20088},
    {"meshes/spot.obj", 5856},
    {"meshes/stanford-bunny.obj", 69451},
    {"meshes/spot_texture.png", 0, "a PNG image"},
    {"defects/40509.stl", 14370},
    {"defects/blobby-shuffled.off", 4050},
    {"defects/chair.off", 1804},
    {"defects/cube-minimal-degenerated.obj", 16},
    {"defects/cube_40k.obj", 96000},
    {"defects/degtri_sliding.off", 8},
    {"defects/dragon_vrip_res3.ply", 47794},
    {"defects/elephant-with-holes.off", 4463},
    {"defects/featuretype.STL", 3476},
    {"defects/moebius.obj", 448},
    {"defects/nancolor.obj", 12},
    {"defects/nearby-bad.stl", 12},
    {"defects/normal-directions-bad.stl", 12},
    {"defects/not_convex.obj", 96},
    {"defects/openscad-nonmanifold-crash.obj", 1442},
    {"defects/rot_seven_cubes.obj", 96},
    {"defects/stratocaster.ply", 8660},
    {"defects/suzanne.obj", 968},
    {"defects/teapot.obj", 6320},
    {"defects/tetra_intersected_by_triangle.off", 5},
    {"defects/three_cylinders.obj", 1188},
    {"defects/triple_vierbein.obj", 108},
    {"defects/truck.obj", 4770},
    {"corrupt/corrupted_invalid_facet_vertex.off", 0, "uses vertex 100"},
    {"corrupt/corrupted_invalid_triangle_count.stl", 0, "promises 22 triangles"},
    {"corrupt/notANumberNormal.ascii.stl", 4, "normal-not-finite"},
    {"corrupt/truncated.ply", 0, "cut off"},
    {"corrupt/wrongHeader.bin.stl", 12, "stl-header"},
    {"volumes/skull_2.9.inr", 0, "an INRIMAGE volume"},
    {"volumes/HeadMRVolume.mhd", 0, "a MetaImage volume"},
    {"volumes/smoke.vdb", 0, "an OpenVDB volume"},
    {"heights/bigtujunga.tif", 0, "a TIFF image"},
    {"heights/brickwall_height.png", 0, "a JPEG image"},
    {"heights/heightmap_16bit.exr", 0, "an OpenEXR image"},
    {"textures3d/perlinvolume.dds", 0, "a DDS texture"},
    {"env/noon_grass_1k.hdr", 0, "a Radiance HDR image"},
};

}  // namespace

TEST_CASE("every mesh of the test data is read, or refused for the reason that the table has") {
  if (!find_data("meshes/spot.obj")) {
    WARN("skipped: the test data are not there");
    return;
  }
  for (const Row& row : kRows) {
    INFO(row.name);
    const auto path = find_data(row.name);
    if (!path) {
      WARN("skipped: " << row.name << " is not there");
      continue;
    }
    MeshReadReport report;
    const Result<PaintedMesh> read = read_painted_mesh(*path, {}, &report);
    if (row.triangles == 0) {
      REQUIRE_FALSE(read.ok());
      CHECK(read.error().code == ErrorCode::kInvalidInput);
      INFO(read.error().message);
      CHECK(read.error().message.find(row.says) != std::string::npos);
      continue;
    }
    INFO((read ? "" : read.error().message));
    REQUIRE(read.ok());
    CHECK(read->mesh.triangles.size() + report.dropped_faces == row.triangles);
    std::vector<std::string> ids;
    for (const MeshWarning& warning : report.warnings) ids.push_back(warning.id);
    CHECK(ids == (*row.says ? std::vector<std::string>{row.says} : std::vector<std::string>{}));
  }
}
