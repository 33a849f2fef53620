#include <string>

#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"

using namespace mesocell;

TEST_CASE("a recipe is split into generator and options") {
  const Result<Recipe> spec = parse_recipe("voronoi:cells=8,resolution=128,seed=1");
  REQUIRE(spec.ok());
  CHECK(spec->name == "voronoi");
  CHECK(spec->options.at("cells") == "8");
  CHECK(spec->options.at("resolution") == "128");
  CHECK(spec->options.at("seed") == "1");
  CHECK(parse_recipe("spheres")->options.empty());
}

TEST_CASE("a wrong recipe is a usage error that names what is wrong") {
  const auto message = [](const std::string& text) {
    const Result<Recipe> spec = parse_recipe(text);
    const Error error = spec.ok() ? make_tile(*spec).error() : spec.error();
    CHECK(error.code == ErrorCode::kUsage);
    return error.message;
  };
  CHECK(message("") != "");
  CHECK(message(":cells=8") != "");
  CHECK(message("voronoi:").find("''") != std::string::npos);
  CHECK(message("voronoi:cells").find("'cells'") != std::string::npos);
  CHECK(message("voronoi:cells=").find("'cells='") != std::string::npos);
  CHECK(message("voronoi:cells=8,cells=9").find("twice") != std::string::npos);
  CHECK(message("marble:cells=8").find("voronoi, spheres, ellipsoids, worley, bricks") != std::string::npos);
  CHECK(message("voronoi:colour=8").find("'colour'") != std::string::npos);
  for (const char* cells : {"0", "65536", "-1", "8.5", "many", "99999999999999999999"})
    CHECK(message(std::string("voronoi:cells=") + cells).find(cells) != std::string::npos);
  for (const char* resolution : {"0", "3", "1025", "-8", "8x8", "8x8x8x8", "8x8x2000", "8xx8", "x8x8"})
    CHECK(message(std::string("voronoi:resolution=") + resolution).find(resolution) != std::string::npos);
  for (const char* seed : {"-1", "one", "1.0", "18446744073709551616"})
    CHECK(message(std::string("voronoi:seed=") + seed).find(seed) != std::string::npos);
  for (const char* own :
       {"voronoi:metric=manhattan", "spheres:metric=euclidean", "voronoi:ric=1", "worley:combine=f5",
        "worley:combine=", "worley:combine=f1f2", "worley:combine=f1-", "worley:combine=x*f1",
        "worley:threshold=nan", "worley:threshold=1000", "worley:keep=both", "bricks:mortar=2",
        "bricks:courses=3", "bricks:cells=7", "bricks:cells=6,courses=4", "bricks:courses=2.5",
        "ellipsoids:flatness=1", "worley:threshold=90"})
    CHECK(message(own) != "");
  CHECK(message("voronoi:cells=65,resolution=4").find("64 voxels") != std::string::npos);
}
