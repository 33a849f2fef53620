#include "converters/vdb/volume_shape.h"

#include <cmath>

#include "sdk/author/cell_object.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"
#include "tests/vdb/volumes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

struct Kind {
  VolumeType type;
  VolumeClass volume_class;
  std::optional<double> iso;
};

/// What was found of the voxels of an instance.
struct Seen {
  bool in = false, out = false;
};

constexpr Kind kKinds[] = {{VolumeType::kFloat, VolumeClass::kLevelSet, std::nullopt},
                           {VolumeType::kFloat, VolumeClass::kLevelSet, -0.25},
                           {VolumeType::kFloat, VolumeClass::kFog, std::nullopt},
                           {VolumeType::kFloat, VolumeClass::kUnknown, 0.1},
                           {VolumeType::kInt, VolumeClass::kUnknown, std::nullopt},
                           {VolumeType::kMask, VolumeClass::kUnknown, std::nullopt}};

}  // namespace

TEST_CASE("volume: what a box is said to be, each of its points is") {
  Rng rng(11);
  std::uint64_t one_sided = 0;
  for (int round = 0; round < 3; ++round)
    for (const Kind& kind : kKinds) {
      const auto shape = VolumeShape::make(random_volume(rng, kind.type, kind.volume_class), kind.iso);
      REQUIRE(shape);
      const Box3 all = (*shape)->box();
      REQUIRE_FALSE(all.empty());
      const Vec3 extent = all.extent();
      std::uint64_t wrong = 0, outside_box = 0, in = 0;
      for (int i = 0; i < 4000; ++i) {
        Box3 box;
        const double size = std::exp2(-double(rng.below(9)));
        Vec3 corner;
        for (std::size_t a = 0; a < 3; ++a) corner[a] = all.min[a] + extent[a] * (1.4 * rng.uniform() - 0.2);
        box.add(corner);
        box.add(corner + extent * (size * rng.uniform()));
        const BoxSide side = (*shape)->side(box);
        one_sided += side != BoxSide::kMixed;
        for (int k = 0; k < 12; ++k) {
          Vec3 p;  // corners first
          for (std::size_t a = 0; a < 3; ++a) {
            const double t = k < 8 ? double(k >> a & 1) : rng.uniform();
            p[a] = box.min[a] + t * (box.max[a] - box.min[a]);
          }
          const bool inside = (*shape)->inside(p);
          in += inside;
          if (side == BoxSide::kInside) wrong += !inside;
          if (side == BoxSide::kOutside) wrong += inside;
          for (std::size_t a = 0; a < 3; ++a)
            outside_box += inside && (p[a] < all.min[a] || p[a] > all.max[a]);
        }
      }
      CHECK(wrong == 0);
      CHECK(outside_box == 0);
      CHECK(in > 20);
    }
  CHECK(one_sided > 10000);
}

TEST_CASE("volume: authoring gives what asking for every voxel does") {
  Rng rng(5);
  std::uint64_t all_inside = 0;
  for (const Kind& kind : kKinds) {
    const auto shape = VolumeShape::make(random_volume(rng, kind.type, kind.volume_class), kind.iso);
    REQUIRE(shape);
    // Nearly each cell a voxel, so that a tag says what its centre is.
    const auto made = make_tile(*parse_recipe("voronoi:cells=400,resolution=8,seed=1"));
    REQUIRE(made);
    AuthorOptions options;
    options.grid.tiles = 12;
    const auto object = author_cell_object(**shape, *made, options);
    REQUIRE(object);
    std::uint64_t wrong = 0, inside = 0;
    Index3 t{};
    for (t[2] = 0; t[2] < object->grid.tiles[2]; ++t[2])
      for (t[1] = 0; t[1] < object->grid.tiles[1]; ++t[1])
        for (t[0] = 0; t[0] < object->grid.tiles[0]; ++t[0]) {
          std::vector<Seen> seen(object->tile.cell_count + 1);
          std::uint64_t index = 0;
          for (std::uint32_t z = 0; z < 8; ++z)
            for (std::uint32_t y = 0; y < 8; ++y)
              for (std::uint32_t x = 0; x < 8; ++x, ++index) {
                const std::uint32_t id = object->tile.id(index);
                if (id == 0) continue;
                const Piece& piece = object->tile.pieces[id - 1];
                Vec3 p;
                bool in_grid = true;
                const Index3 v{x, y, z};
                for (std::size_t a = 0; a < 3; ++a) {
                  const std::int64_t at = std::int64_t{t[a]} - piece.home[a];
                  in_grid = in_grid && at >= 0 && at < object->grid.tiles[a];
                  p[a] = object->grid.box_min[a] + (double(at * 8 + v[a]) + 0.5) * object->grid.voxel_edge;
                }
                (in_grid && (*shape)->inside(p) ? seen[piece.cell].in : seen[piece.cell].out) = true;
              }
          for (std::uint32_t c = 1; c <= object->tile.cell_count; ++c) {
            const Tag tag = object->membership.tag(object->grid.tile_index(t[0], t[1], t[2]), c);
            const Tag expected = seen[c].in && seen[c].out ? Tag::kIntersected
                                 : seen[c].in              ? Tag::kInside
                                                           : Tag::kOutside;
            wrong += tag != expected;
            inside += tag == Tag::kInside;
          }
        }
    CHECK(wrong == 0);
    all_inside += inside;
  }
  CHECK(all_inside > 100);
}

TEST_CASE("volume: a ball's box and inside are those of the ball") {
  const double edge = 0.05;
  const auto shape = VolumeShape::make(ball_volume(1, edge), std::nullopt);
  REQUIRE(shape);
  for (std::size_t a = 0; a < 3; ++a) {
    // A sample is solid up to the surface, and what is between it and the next may be.
    CHECK((*shape)->box().max[a] >= 1);
    CHECK((*shape)->box().max[a] <= 1 + edge);
    CHECK((*shape)->box().min[a] <= -1);
    CHECK((*shape)->box().min[a] >= -1 - edge);
  }
  Rng rng(3);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 p{3 * rng.uniform() - 1.5, 3 * rng.uniform() - 1.5, 3 * rng.uniform() - 1.5};
    if (std::abs(length(p) - 1) > 1e-3) CHECK((*shape)->inside(p) == (length(p) < 1));
  }
  const auto smaller = VolumeShape::make(ball_volume(1, edge), -0.1);
  REQUIRE(smaller);
  CHECK((*smaller)->inside({0.89, 0, 0}));
  CHECK_FALSE((*smaller)->inside({0.91, 0, 0}));
}

TEST_CASE("volume: what is no shape is refused") {
  const auto code = [](SparseVolume volume, std::optional<double> iso) {
    const auto shape = VolumeShape::make(std::move(volume), iso);
    REQUIRE_FALSE(shape);
    CHECK(shape.error().message.size() > 20);
    return shape.error().code;
  };
  Rng rng(1);
  const SparseVolume ball = ball_volume(1, 0.1);
  CHECK(code(ball, 0.5) == ErrorCode::kInvalidInput);   // beyond the band: all of space
  CHECK(code(ball, -0.5) == ErrorCode::kInvalidInput);  // nothing
  SparseVolume fog = random_volume(rng, VolumeType::kFloat, VolumeClass::kFog);
  CHECK(code(fog, -0.5) == ErrorCode::kInvalidInput);
  CHECK(code(fog, 2) == ErrorCode::kInvalidInput);
  for (float& v : fog.floats) v = 0;
  fog.tiles.clear();
  CHECK(code(fog, std::nullopt) == ErrorCode::kInvalidInput);
  CHECK(code(random_volume(rng, VolumeType::kMask, VolumeClass::kUnknown), 1) == ErrorCode::kUsage);
  CHECK(code(random_volume(rng, VolumeType::kFloat3, VolumeClass::kUnknown), std::nullopt) ==
        ErrorCode::kInvalidInput);
  CHECK(code(SparseVolume(), std::nullopt) == ErrorCode::kInvalidInput);
}

TEST_CASE("volume: colors are linear light between samples") {
  SparseVolume volume;
  volume.type = VolumeType::kFloat3;
  volume.leaves.push_back({{0, 0, 0}, {}});
  volume.floats.resize(512 * 3);
  for (std::size_t v = 0; v < 512; ++v) volume.floats[3 * v] = float(v % 8) / 7;
  volume.index_to_world = scaling({2, 2, 2});
  const auto colors = VolumeColors::make(volume);
  REQUIRE(colors);
  CHECK((*colors)->at({0, 4, 4}) == Rgb8{0, 0, 0});
  CHECK((*colors)->at({14, 4, 4}) == Rgb8{255, 0, 0});
  CHECK((*colors)->at({7, 4, 4}) == Rgb8{188, 0, 0});  // half of the light
  volume.type = VolumeType::kFloat;
  volume.floats.resize(512);
  CHECK_FALSE(VolumeColors::make(volume));
}

TEST_CASE("volume: labels are those of the active box, or of the resolution that is stated") {
  SparseVolume volume;
  volume.type = VolumeType::kInt;
  volume.leaves.push_back({{8, 0, -8}, {}});
  volume.ints.resize(512);
  const auto set = [&](std::size_t x, std::size_t y, std::size_t z, std::int32_t v) {
    volume.ints[x + 8 * (y + 8 * z)] = v;
    volume.leaves[0].active[z] |= std::uint64_t{1} << (x + 8 * y);
  };
  set(1, 2, 3, 7);
  set(4, 6, 7, 9);
  set(2, 2, 4, -5);
  auto labels = labels_of(volume);
  REQUIRE(labels);
  CHECK(labels->resolution == Index3{4, 5, 5});
  CHECK(labels->labels.front() == 7);
  CHECK(labels->labels.back() == 9);
  CHECK(labels->labels[1 + 4 * (0 + 5 * 1)] == 0);  // a negative one
  volume.metadata.emplace_back("mesocell:resolution", "16 8 4");
  labels = labels_of(volume);
  REQUIRE(labels);
  CHECK(labels->resolution == Index3{16, 8, 4});
  for (const char* bad : {"", "16", "16 8", "16 8 4 ", "16 8 4x", "0 1 1", "2000 1 1", "-1 1 1", "1  1 1"}) {
    volume.metadata[0].second = bad;
    CHECK_FALSE(labels_of(volume));
  }
  volume.metadata.clear();
  volume.tiles.push_back({{4096, 0, 0}, 3, true, {1, 1, 1}});
  CHECK(labels_of(volume).error().code == ErrorCode::kLimit);
  volume.type = VolumeType::kFloat;
  CHECK_FALSE(labels_of(volume));
}
