#include "sdk/membership/solid_shape.h"

#include <array>
#include <cmath>
#include <vector>

#include "sdk/author/cell_object.h"
#include "sdk/core/rng.h"
#include "sdk/membership/membership.h"
#include "sdk/tiles/tile_spec.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

/// Balls, one of which may be hollow.
class Balls final : public SolidShape {
 public:
  struct Ball {
    Vec3 centre;
    double radius, hollow;
  };
  explicit Balls(std::vector<Ball> balls) : balls_(std::move(balls)) {}

  [[nodiscard]] Box3 box() const override {
    Box3 box;
    for (const Ball& b : balls_) {
      box.add(b.centre - Vec3{b.radius, b.radius, b.radius});
      box.add(b.centre + Vec3{b.radius, b.radius, b.radius});
    }
    return box;
  }
  [[nodiscard]] bool inside(Vec3 p) const override {
    ++asked;
    for (const Ball& b : balls_)
      if (length(p - b.centre) <= b.radius && length(p - b.centre) >= b.hollow) return true;
    return false;
  }
  [[nodiscard]] BoxSide side(const Box3& box) const override {
    BoxSide side = BoxSide::kOutside;
    for (const Ball& b : balls_) {
      Vec3 near, far;
      for (std::size_t a = 0; a < 3; ++a) {
        near[a] = std::max({box.min[a] - b.centre[a], b.centre[a] - box.max[a], 0.0});
        far[a] = std::max(std::abs(box.min[a] - b.centre[a]), std::abs(box.max[a] - b.centre[a]));
      }
      if (length(near) >= b.hollow * (1 + 1e-12) && length(far) <= b.radius * (1 - 1e-12))
        return BoxSide::kInside;
      if (length(near) <= b.radius * (1 + 1e-12) && length(far) >= b.hollow * (1 - 1e-12))
        side = BoxSide::kMixed;
    }
    return side;
  }
  mutable std::uint64_t asked = 0;

 private:
  std::vector<Ball> balls_;
};

/// The tag of an instance from all its voxels, one by one.
Tag slow_tag(const SolidShape& shape, const CellObject& object, const Index3& home, std::uint32_t cell) {
  const TileMap& tile = object.tile;
  bool in = false, out = false;
  std::uint64_t index = 0;
  for (std::uint32_t z = 0; z < tile.resolution[2]; ++z)
    for (std::uint32_t y = 0; y < tile.resolution[1]; ++y)
      for (std::uint32_t x = 0; x < tile.resolution[0]; ++x, ++index) {
        const std::uint32_t id = tile.id(index);
        if (id == 0 || tile.pieces[id - 1].cell != cell) continue;
        const std::array<std::uint32_t, 3> local{x, y, z};
        Vec3 p;
        bool in_grid = true;
        for (std::size_t a = 0; a < 3; ++a) {
          const std::int64_t tile_at = std::int64_t{home[a]} - tile.pieces[id - 1].home[a];
          in_grid = in_grid && tile_at >= 0 && tile_at < object.grid.tiles[a];
          p[a] = object.grid.box_min[a] +
                 (double(tile_at * tile.resolution[a] + local[a]) + 0.5) * object.grid.voxel_edge;
        }
        (in_grid && shape.inside(p) ? in : out) = true;
      }
  return in && out ? Tag::kIntersected : in ? Tag::kInside : Tag::kOutside;
}

}  // namespace

TEST_CASE("a shape that is no mesh gives each instance the tag that its voxels' centres have") {
  Rng rng(7);
  for (const char* recipe :
       {"voronoi:cells=8,resolution=16,seed=3", "voronoi:cells=100,resolution=12x20x9,seed=1",
        "spheres:cells=6,resolution=16,seed=2"}) {
    for (int round = 0; round < 3; ++round) {
      std::vector<Balls::Ball> balls;
      for (int k = 0; k < 3; ++k)
        balls.push_back({{rng.uniform(), rng.uniform(), rng.uniform()}, 0.1 + 0.4 * rng.uniform(), 0});
      balls[0].hollow = balls[0].radius * 0.5;
      const Balls shape(balls);
      auto tile = make_tile(*parse_recipe(recipe));
      REQUIRE(tile);
      AuthorOptions options;
      options.grid.tiles = 5;
      options.threads = unsigned(round);
      const auto object = author_cell_object(shape, *tile, options);
      REQUIRE(object);
      std::uint64_t wrong = 0, inside = 0;
      Index3 t{};
      for (t[2] = 0; t[2] < object->grid.tiles[2]; ++t[2])
        for (t[1] = 0; t[1] < object->grid.tiles[1]; ++t[1])
          for (t[0] = 0; t[0] < object->grid.tiles[0]; ++t[0])
            for (std::uint32_t c = 1; c <= object->tile.cell_count; ++c) {
              const Tag tag = object->membership.tag(object->grid.tile_index(t[0], t[1], t[2]), c);
              inside += tag == Tag::kInside;
              wrong += tag != slow_tag(shape, *object, t, c);
            }
      INFO(recipe);
      CHECK(wrong == 0);
      CHECK(inside > 10);
    }
  }
}

TEST_CASE("far from its surface a shape is asked for boxes, not for voxels") {
  const Balls shape({{{0, 0, 0}, 1, 0}});
  auto tile = make_tile(*parse_recipe("voronoi:cells=8,resolution=32,seed=1"));
  AuthorOptions options;
  options.grid.tiles = 8;
  options.threads = 1;
  const auto object = author_cell_object(shape, *tile, options);
  REQUIRE(object);
  // 256³ voxels; the surface passes through π · 256² of them, in boxes of two or so.
  CHECK(shape.asked > 256 * 256);
  CHECK(shape.asked < 256 * 256 * 16);
}

TEST_CASE("what a shape without triangles cannot be is refused") {
  const auto tile = make_tile(*parse_recipe("voronoi:cells=8,resolution=16,seed=1"));
  AuthorOptions options;
  const auto empty = author_cell_object(Balls({}), *tile, options);
  REQUIRE_FALSE(empty);
  CHECK(empty.error().code == ErrorCode::kInvalidInput);
  options.rule = MembershipRule::kConservative;
  const auto conservative = author_cell_object(Balls({{{0, 0, 0}, 1, 0}}), *tile, options);
  REQUIRE_FALSE(conservative);
  CHECK(conservative.error().code == ErrorCode::kUsage);
}
