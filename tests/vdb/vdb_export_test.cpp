#include "converters/vdb/assemble_object.h"
#include "converters/vdb/vdb_export.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>

#include "converters/vdb/assemble_object.h"
#include "converters/vdb/object_voxels.h"
#include "converters/vdb/vdb_object.h"
#include "converters/vdb/volume_lookup.h"
#include "converters/vdb/volume_shape.h"
#include "format/cell_object_io.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/srgb.h"
#include "sdk/surface/color.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"
#include "tests/support/objects.h"
#include "tests/support/shapes.h"
#include "tests/vdb/volumes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

CellObject authored(const std::string& recipe, MembershipRule rule, std::uint32_t tiles) {
  auto tile = make_tile(*parse_recipe(recipe));
  REQUIRE(tile);
  AuthorOptions options;
  options.rule = rule;
  options.grid.tiles = tiles;
  auto object = author_cell_object(make_torus({0.1, -2, 3.3}, 1, 0.4, 24, 12), std::move(*tile), options);
  REQUIRE(object);
  return std::move(*object);
}

SparseVolume read_grid(const std::string& path, const std::string& name) {
  VdbReadOptions options;
  options.grid = name;
  options.purpose = VdbPurpose::kAny;
  auto volume = read_vdb(path, options);
  REQUIRE(volume);
  return std::move(*volume);
}

}  // namespace

TEST_CASE("vdb export: labels restore grid, tile and tags") {
  const Folder folder(in_memory());
  const std::string path = folder / "labels.vdb", again = folder / "again.vdb";
  for (const char* recipe :
       {"voronoi:cells=8,resolution=16,seed=3", "voronoi:cells=60,resolution=12x20x9,seed=1",
        "spheres:cells=6,resolution=16,seed=2", "voronoi:cells=1,resolution=4,seed=1"})
    for (const MembershipRule rule : {MembershipRule::kCentre, MembershipRule::kConservative}) {
      INFO(recipe);
      CellObject object = authored(recipe, rule, 6);
      VdbExportOptions options;
      options.kinds.labels = true;
      VdbExportReport report;
      REQUIRE(export_vdb(object, path, options, &report));
      CHECK(report.grids.size() == 4);
      CHECK(report.bytes == content(path).size());
      CHECK(is_vdb_object(path));
      const auto back = read_vdb_object(path);
      if (!back) FAIL(back.error().message);
      CHECK((back->grid == object.grid));
      CHECK((back->tile == object.tile));
      CHECK((back->membership == object.membership));
      options.threads = 1;
      REQUIRE(export_vdb(*back, again, options));
      CHECK((content(again) == content(path)));
    }
}

TEST_CASE("vdb export: cells are the voxels of instances that are inside") {
  const Folder folder(in_memory());
  const CellObject object = authored("voronoi:cells=8,resolution=16,seed=3", MembershipRule::kCentre, 5);
  VdbExportOptions options;
  options.kinds = {.level_set = false, .fog = true, .labels = true, .colors = false};
  REQUIRE(export_vdb(object, folder / "a.vdb", options));
  const SparseVolume cells = read_grid(folder / "a.vdb", "cell"),
                     fog = read_grid(folder / "a.vdb", "density");
  const VolumeLookup cell(cells), density(fog);
  CHECK(fog.volume_class == VolumeClass::kFog);
  const ObjectVoxels voxels(object);
  ObjectVoxels::Reader reader(voxels);
  std::uint64_t wrong = 0, inside = 0;
  VoxelCoord v;
  for (v[2] = -1; v[2] <= voxels.size()[2]; ++v[2])
    for (v[1] = -1; v[1] <= voxels.size()[1]; ++v[1])
      for (v[0] = -1; v[0] <= voxels.size()[0]; ++v[0]) {
        const ObjectVoxels::Found found = reader.at(v);
        const bool in = found.tag == Tag::kInside;
        inside += in;
        wrong += cell.value(v) != (in ? double(found.cell) : 0.0) || density.value(v) != (in ? 1.0 : 0.0);
      }
  CHECK(wrong == 0);
  CHECK(inside == count_inside_voxels(object));
  // Fog of the voxels as a shape is the voxels again: a centre is inside where its voxel is.
  const auto shape = VolumeShape::make(fog, std::nullopt);
  REQUIRE(shape);
  std::uint64_t shape_wrong = 0;
  for (v[2] = 0; v[2] < voxels.size()[2]; ++v[2])
    for (v[1] = 0; v[1] < voxels.size()[1]; ++v[1])
      for (v[0] = 0; v[0] < voxels.size()[0]; ++v[0])
        shape_wrong += (*shape)->inside(to_vec3(object.grid.box_min) +
                                        Vec3{v[0] + 0.5, v[1] + 0.5, v[2] + 0.5} * object.grid.voxel_edge) !=
                       (reader.at(v).tag == Tag::kInside);
  CHECK(shape_wrong == 0);
}

TEST_CASE("vdb export: distances are those to the nearest voxel's cube, by brute force") {
  const Folder folder(in_memory());
  Rng rng(4);
  const CellObject object = random_object(rng, "voronoi:cells=12,resolution=10,seed=5", {3, 2, 2}, 0.3);
  for (const bool part : {false, true}) {
    VdbExportOptions options;
    options.kinds.level_set = true;
    VoxelCoord low{0, 0, 0}, high{30, 20, 20};
    if (part) {
      options.tiles = TileBox{{1, 0, 1}, {2, 2, 2}};
      low = {10, 0, 10};
      high = {20, 20, 20};
    }
    REQUIRE(export_vdb(object, folder / "d.vdb", options));
    const SparseVolume surface = read_grid(folder / "d.vdb", "surface");
    CHECK(surface.volume_class == VolumeClass::kLevelSet);
    const VolumeLookup lookup(surface);
    const ObjectVoxels voxels(object);
    ObjectVoxels::Reader reader(voxels);
    const auto inside = [&](const VoxelCoord& v) {
      for (std::size_t a = 0; a < 3; ++a)
        if (v[a] < low[a] || v[a] >= high[a]) return false;
      return reader.at(v).tag == Tag::kInside;
    };
    std::uint64_t wrong = 0, band = 0;
    VoxelCoord v;
    for (v[2] = -6; v[2] < 26; ++v[2])
      for (v[1] = -6; v[1] < 26; ++v[1])
        for (v[0] = -6; v[0] < 36; ++v[0]) {
          const bool in = inside(v);
          double nearest = 3;
          for (int dz = -4; dz <= 4; ++dz)
            for (int dy = -4; dy <= 4; ++dy)
              for (int dx = -4; dx <= 4; ++dx)
                if (inside({v[0] + dx, v[1] + dy, v[2] + dz}) != in) {
                  const auto gap = [](int d) { return std::max(std::abs(d) - 0.5, 0.0); };
                  nearest = std::min(nearest, length(Vec3{gap(dx), gap(dy), gap(dz)}));
                }
          band += nearest < 3;
          wrong += std::abs(lookup.value(v) - (in ? -nearest : nearest)) > 1e-6;
        }
    CHECK(wrong == 0);
    CHECK(band > 1000);
  }
}

TEST_CASE("vdb export: colors are linear light, of tile, cell and instance") {
  const Folder folder(in_memory());
  CellObject object = authored("voronoi:cells=8,resolution=8,seed=3", MembershipRule::kCentre, 4);
  const std::uint64_t inside = count_instances(object.membership).inside;
  object.cell_colors = ColorList{std::vector<Rgb8>(8, Rgb8{255, 255, 255})};
  object.cell_colors->colors[2] = {188, 255, 0};
  object.instance_colors = ColorList{std::vector<Rgb8>(inside, Rgb8{255, 128, 255})};
  VdbExportOptions options;
  options.kinds.colors = true;
  VdbExportReport report;
  REQUIRE(export_vdb(object, folder / "c.vdb", options, &report));
  const SparseVolume grid = read_grid(folder / "c.vdb", "Cd");
  const VolumeLookup colors(grid);
  const ObjectVoxels voxels(object);
  ObjectVoxels::Reader reader(voxels);
  std::uint64_t wrong = 0;
  VoxelCoord v;
  for (v[2] = 0; v[2] < voxels.size()[2]; ++v[2])
    for (v[1] = 0; v[1] < voxels.size()[1]; ++v[1])
      for (v[0] = 0; v[0] < voxels.size()[0]; ++v[0]) {
        const ObjectVoxels::Found found = reader.at(v);
        Vec3 expected;
        if (found.tag == Tag::kInside) {
          expected = srgb_to_linear(object.cell_colors->colors[found.cell - 1]);
          expected.y *= srgb_to_linear(128);
        }
        const VolumeValue is = colors.numbers(v);
        for (std::size_t c = 0; c < 3; ++c) wrong += std::abs(is[c] - expected[c]) > 1e-6;
      }
  CHECK(wrong == 0);
}

TEST_CASE("vdb export: what cannot be written is refused") {
  const Folder folder(in_memory());
  const CellObject object = authored("voronoi:cells=8,resolution=16,seed=3", MembershipRule::kCentre, 5);
  const std::string path = folder / "a.vdb";
  VdbExportOptions options;
  CHECK(export_vdb(object, path, options).error().code == ErrorCode::kUsage);
  options.kinds.labels = true;
  options.tiles = TileBox{{0, 0, 0}, {1, 1, 1}};
  CHECK(export_vdb(object, path, options).error().code == ErrorCode::kUsage);
  options.kinds = {.level_set = true};
  options.tiles = TileBox{{0, 0, 0}, {1, 1, 100}};
  CHECK(export_vdb(object, path, options).error().code == ErrorCode::kUsage);
  options.tiles.reset();
  options.max_voxels = 5000;
  const Status limited = export_vdb(object, path, options);
  REQUIRE_FALSE(limited);
  CHECK(limited.error().code == ErrorCode::kLimit);
  CHECK(limited.error().message.find("million") != std::string::npos);
  options.max_voxels = 1 << 27;
  std::atomic<bool> cancel = true;
  const Progress progress{nullptr, &cancel};
  CHECK(export_vdb(object, path, options, nullptr, &progress).error().code == ErrorCode::kCancelled);
  CHECK(export_vdb(object, folder / "no/such/folder/a.vdb", options).error().code == ErrorCode::kOutput);
  CHECK(folder.count() == 0);
}

TEST_CASE("vdb export: grids that contradict each other are no asset") {
  const Folder folder(in_memory());
  const CellObject object = authored("voronoi:cells=8,resolution=16,seed=3", MembershipRule::kCentre, 4);
  VdbExportOptions options;
  options.kinds.labels = true;
  REQUIRE(export_vdb(object, folder / "a.vdb", options));
  const SparseVolume tile = read_grid(folder / "a.vdb", "tile"),
                     home = read_grid(folder / "a.vdb", "tile_home"),
                     tags = read_grid(folder / "a.vdb", "membership");
  REQUIRE(assemble_object(tile, home, tags));
  const auto refused = [&](auto change) {
    SparseVolume t = tile, h = home, m = tags;
    change(t, h, m);
    const auto made = assemble_object(t, h, m);
    CHECK_FALSE(made);
  };
  using V = SparseVolume;
  refused([](V& t, V&, V&) { t.metadata.clear(); });
  refused([](V& t, V&, V&) { t.ints[77] = 9; });
  refused([](V& t, V&, V&) { t.ints[77] = -1; });
  refused([](V& t, V&, V&) { t.ints.assign(t.ints.size(), 0); });
  refused([](V& t, V&, V&) { t.ints.assign(t.ints.size(), 8); });
  refused([](V&, V& h, V&) { h.ints.assign(h.ints.size(), 1); });
  const auto full = std::size_t(
      std::find_if(tile.ints.begin(), tile.ints.end(), [](auto c) { return c != 0; }) - tile.ints.begin());
  refused([&](V&, V& h, V&) { h.ints[3 * full] = 128; });
  refused([](V&, V&, V& m) { m.ints.assign(m.ints.size(), 3); });
  refused([](V&, V&, V& m) {
    m.type = VolumeType::kFloat;
    m.floats.resize(m.ints.size());
  });
  const auto with = [&](const std::string& key, const std::string& value) {
    refused([&](V& t, V&, V&) {
      for (auto& [name, text] : t.metadata)
        if (name == "mesocell:" + key) text = value;
    });
  };
  with("version", "2");
  for (const char* bad : {"", "0 0", "0 0 nan", "0 0 inf", "0 0 0 0", "1e308x 0 0"}) with("box_min", bad);
  for (const char* bad : {"", "0", "-1", "inf", "nan", "1 1", "1e308"}) with("voxel_edge", bad);
  for (const char* bad : {"", "0 1 1", "-1 1 1", "1 1", "4294967295 4294967295 4294967295", "100000000 1 1"})
    with("tiles", bad);
  for (const char* bad : {"", "3 16 16", "16 16 1025", "16 16", "8 16 16x"}) with("resolution", bad);
  with("rule", "other");
  for (const char* bad : {"", "0", "65536", "7", "9"}) with("cells", bad);
  // Any damage gives a sound object or none.
  Rng rng(3);
  std::uint64_t made_well = 0;
  for (int round = 0; round < 300; ++round) {
    SparseVolume t = tile, h = home, m = tags;
    for (std::uint32_t k = 0; k <= rng.below(2); ++k) {
      const std::int32_t value = std::int32_t(rng.below(12)) - 2;
      const std::uint32_t which = rng.below(3);
      if (which == 0) t.ints[rng.below(std::uint32_t(t.ints.size()))] = value;
      if (which == 1) h.ints[rng.below(std::uint32_t(h.ints.size()))] = value - 3;
      if (which == 2) m.ints[rng.below(std::uint32_t(m.ints.size()))] = value;
    }
    const auto made = assemble_object(t, h, m);
    made_well += made.ok();
    if (made) CHECK(read_cell_object(*encode_cell_object(*made)));
  }
  CHECK(made_well > 10);
  CHECK(made_well < 290);
}
