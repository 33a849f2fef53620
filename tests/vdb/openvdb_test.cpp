#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetMeasure.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "converters/vdb/vdb_export.h"
#include "converters/vdb/vdb_file.h"
#include "converters/vdb/volume_shape.h"
#include "sdk/author/cell_object.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/folder.h"
#include "tests/support/shapes.h"
#include "tests/vdb/volumes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

openvdb::FloatGrid::Ptr open_grid(const std::string& path, const std::string& name) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(false);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
}

/// Asks both at random points in and about the box. Values agree but for the rounding of OpenVDB's, which are
/// floats; so what is inside does wherever the value is further from iso than that.
void compare(const openvdb::FloatGrid& theirs, const VolumeShape& ours, std::uint64_t seed) {
  const VolumeLookup lookup(ours.volume());
  const Transform world_to_index = *ours.volume().index_to_world.inverse();
  const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(theirs);
  const bool level_set = theirs.getGridClass() == openvdb::GRID_LEVEL_SET;
  Rng rng(seed);
  const Box3 box = ours.box();
  double greatest = 0, scale = 0;
  std::uint64_t wrong = 0, inside = 0, near = 0;
  for (int i = 0; i < 100000; ++i) {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a) p[a] = box.min[a] + box.extent()[a] * (1.2 * rng.uniform() - 0.1);
    const double value = double(sampler.wsSample(openvdb::Vec3R(p.x, p.y, p.z)));
    greatest = std::max(greatest, std::abs(value - lookup.interpolate(world_to_index.point(p))));
    scale = std::max(scale, std::abs(value));
    const bool in = level_set ? value < *ours.iso() : value >= *ours.iso();
    inside += in;
    if (std::abs(value - *ours.iso()) < 1e-5 * std::max(1.0, scale))
      ++near;
    else
      wrong += in != ours.inside(p);
  }
  CHECK(wrong == 0);
  CHECK(greatest <= 1e-5 * std::max(1.0, scale));
  CHECK(inside > 50);
  CHECK(near < 100);
}

}  // namespace

TEST_CASE("openvdb: its own sampler finds the same values and the same inside") {
  for (const char* name : {"smoke", "sphere", "torus01"}) {
    const auto path = find_data("volumes/" + std::string(name) + ".vdb");
    if (!path) return;
    INFO(name);
    VdbReadReport report;
    const auto volume = read_vdb(*path, {}, &report);
    REQUIRE(volume);
    const auto shape = VolumeShape::make(*volume, std::nullopt);
    REQUIRE(shape);
    compare(*open_grid(*path, report.grid), **shape, 1);
  }
}

TEST_CASE("openvdb: also of sparse grids with any transform, written by us") {
  const Folder folder(in_memory());
  Rng rng(9);
  for (int round = 0; round < 6; ++round) {
    const SparseVolume volume =
        random_volume(rng, VolumeType::kFloat, round % 2 ? VolumeClass::kFog : VolumeClass::kUnknown);
    const std::string path = folder / (std::to_string(round) + ".vdb");
    REQUIRE(write_vdb(path, std::span(&volume, 1)));
    const auto shape = VolumeShape::make(volume, std::nullopt);
    REQUIRE(shape);
    compare(*open_grid(path, "random"), **shape, std::uint64_t(round));
  }
}

TEST_CASE("openvdb: the volume that it measures of an exported level set is that of the voxels inside") {
  const Folder folder(in_memory());
  for (const char* recipe : {"voronoi:cells=8,resolution=32,seed=1", "spheres:cells=6,resolution=32,seed=2"})
    for (const std::uint32_t tiles : {3u, 5u}) {
      INFO(recipe);
      auto tile = make_tile(*parse_recipe(recipe));
      REQUIRE(tile);
      AuthorOptions author;
      author.grid.tiles = tiles;
      const auto object =
          author_cell_object(make_torus({0, 0, 0}, 1, 0.45, 48, 24), std::move(*tile), author);
      REQUIRE(object);
      VdbExportOptions options;
      options.kinds.level_set = true;
      const std::string path = folder / "surface.vdb";
      REQUIRE(export_vdb(*object, path, options));
      const openvdb::FloatGrid::Ptr grid = open_grid(path, "surface");
      REQUIRE(grid);
      CHECK(grid->getGridClass() == openvdb::GRID_LEVEL_SET);
      const double theirs = double(openvdb::tools::levelSetVolume(*grid, true));
      // What is solid is the union of cubes; at its edges and corners, where the distance has a kink that no
      // grid resolves, their integral rounds. By the area A of the voxels' faces that is a share of A times
      // the edge.
      std::printf("%s, %u tiles: volume %.6g, by OpenVDB %.6g: %+.3f %%\n", recipe, tiles,
                  inside_volume(*object), theirs, 100 * (theirs / inside_volume(*object) - 1));
      CHECK(std::abs(theirs - inside_volume(*object)) <= 0.01 * inside_volume(*object));
    }
}
