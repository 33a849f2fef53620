#include "converters/bench/oracle.h"

#include <cmath>

#include "sdk/trace/walk.h"

namespace mesocell {
namespace {

/// The cell whose INSIDE instance holds a voxel of the grid, 0 if there is none.
std::uint32_t inside_cell(const CellObject& o, const Voxel& v) {
  Index3 at{}, home{};
  std::array<std::int64_t, 3> tile{};
  for (std::size_t a = 0; a < 3; ++a) {
    tile[a] = v[a] / o.tile.resolution[a];
    at[a] = std::uint32_t(v[a] % o.tile.resolution[a]);
  }
  const std::uint32_t id = o.tile.id(o.tile.voxel_index(at[0], at[1], at[2]));
  if (id == 0) return 0;
  const Piece& piece = o.tile.pieces[id - 1];
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t h = tile[a] + piece.home[a];
    if (h < 0 || h >= o.grid.tiles[a]) return 0;
    home[a] = std::uint32_t(h);
  }
  const Tag tag = o.membership.tag(o.grid.tile_index(home[0], home[1], home[2]), piece.cell);
  return tag == Tag::kInside ? piece.cell : 0;
}

}  // namespace

StreamHit walk_to_hit(const CellObject& object, const Ray& ray) {
  const double edge = object.grid.voxel_edge;
  Voxel size{};
  for (std::size_t a = 0; a < 3; ++a)
    size[a] = std::int64_t(object.grid.tiles[a]) * object.tile.resolution[a];
  WalkRay walk;
  WalkPlace place;
  if (!WalkRay::make({(ray.origin - to_vec3(object.grid.box_min)) / edge, ray.direction}, walk) ||
      !enter_grid(walk, size, place))
    return {};
  const auto in_grid = [&](const Voxel& v) {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < 0 || v[a] >= size[a]) return false;
    return true;
  };
  while (in_grid(place.voxel)) {
    const Voxel& v = place.voxel;
    if (const std::uint32_t cell = inside_cell(object, v)) {
      StreamHit hit;
      hit.t = place.t * walk.scale * edge;
      hit.label = cell;
      for (std::size_t a = 0; a < 3; ++a) hit.element[a] = std::int32_t(v[a]);
      if (const int entry = entry_axis(walk, v); entry >= 0) {
        const std::size_t axis = std::size_t(entry);
        hit.face = std::int8_t(2 * axis + (walk.rises(axis) ? 0 : 1));
      }
      return hit;
    }
    leave_box(walk, v, {v[0] + 1, v[1] + 1, v[2] + 1}, place);
  }
  return {};
}

bool same_hit(const StreamHit& a, const StreamHit& b, double voxel_edge) {
  if (a.hit() != b.hit()) return false;
  if (!a.hit()) return true;
  return a.element == b.element && a.label == b.label && a.face == b.face &&
         std::abs(a.t - b.t) <= 1e-6 * voxel_edge;
}

}  // namespace mesocell
