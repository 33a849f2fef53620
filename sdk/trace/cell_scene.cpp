#include "sdk/trace/cell_scene.h"

#include <algorithm>
#include <cmath>

#include "sdk/trace/reach.h"

namespace mesocell {
namespace {

/// Voxels on each side that a shading normal looks at.
constexpr std::int64_t kNormalRadius = 3;

}  // namespace

CellScene::CellScene(const CellObject& object)
    : tile_(object.tile),
      membership_(object.membership),
      box_{to_vec3(object.grid.box_min), to_vec3(object.box_max())},
      voxel_edge_(object.grid.voxel_edge) {
  for (std::size_t a = 0; a < 3; ++a) {
    resolution_[a] = object.tile.resolution[a];
    tiles_[a] = object.grid.tiles[a];
    size_[a] = resolution_[a] * tiles_[a];
  }
  voxel_reach_ = instance_reach(tile_);
  measure_tiles();
}

double CellScene::tile_edge() const {
  return double(*std::max_element(resolution_.begin(), resolution_.end()));
}

bool CellScene::tile_is_empty(const Voxel& t) const {
  for (const Piece& p : tile_.pieces) {
    const Voxel h{t[0] + p.home[0], t[1] + p.home[1], t[2] + p.home[2]};
    if (h[0] < 0 || h[1] < 0 || h[2] < 0 || h[0] >= tiles_[0] || h[1] >= tiles_[1] || h[2] >= tiles_[2])
      continue;
    if (membership_.tag(tile_index(h), p.cell) == Tag::kInside) return false;
  }
  return true;
}

void CellScene::measure_tiles() {
  tile_reach_.resize(std::size_t(tiles_[0] * tiles_[1] * tiles_[2]));
  Voxel t{};
  for (t[2] = 0; t[2] < tiles_[2]; ++t[2])
    for (t[1] = 0; t[1] < tiles_[1]; ++t[1])
      for (t[0] = 0; t[0] < tiles_[0]; ++t[0]) tile_reach_[tile_index(t)] = tile_is_empty(t) ? 255 : 0;
  chebyshev_transform(tile_reach_, membership_.tiles, Border::kOpen);
}

CellScene::Sample CellScene::sample_in(const Voxel& tile, const Voxel& v) const {
  Sample s;
  s.in_tile = std::uint64_t(v[0] - tile[0] * resolution_[0] +
                            resolution_[0] * (v[1] - tile[1] * resolution_[1] +
                                              resolution_[1] * (v[2] - tile[2] * resolution_[2])));
  const std::uint32_t id = tile_.id(s.in_tile);
  if (id == 0) return s;
  const Piece& piece = tile_.pieces[id - 1];
  s.cell = piece.cell;
  const Voxel h{tile[0] + piece.home[0], tile[1] + piece.home[1], tile[2] + piece.home[2]};
  if (h[0] < 0 || h[1] < 0 || h[2] < 0 || h[0] >= tiles_[0] || h[1] >= tiles_[1] || h[2] >= tiles_[2])
    return s;
  s.home = std::int64_t(tile_index(h));
  s.inside = membership_.tag(std::uint64_t(s.home), s.cell) == Tag::kInside;
  return s;
}

bool CellScene::empty_around(const Voxel& tile, Voxel& low, Voxel& high) const {
  const std::int64_t reach = tile_reach_[tile_index(tile)];
  if (reach == 0) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = (tile[a] - reach + 1) * resolution_[a];
    high[a] = (tile[a] + reach) * resolution_[a];
  }
  return true;
}

bool CellScene::empty_box(const Voxel& v, Voxel& low, Voxel& high, Sample& sample) const {
  const Voxel tile = tile_of(v);
  if (empty_around(tile, low, high)) return true;
  sample = sample_in(tile, v);
  if (sample.inside) return false;
  const std::int64_t reach = voxel_reach_[sample.in_tile];
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = v[a] - reach;
    high[a] = v[a] + reach + 1;
  }
  return true;
}

Ray CellScene::to_voxels(const Ray& ray) const {
  // Multiplying the direction by the edge would do as well; t is in metres if it stays as it is and the
  // origin is divided, so t in voxels is t / edge.
  return {(ray.origin - box_.min) / voxel_edge_, ray.direction};
}

void CellScene::set_hit(const WalkRay& ray, const WalkPlace& place, const Sample& sample, Hit& hit) const {
  hit.t = place.t * ray.scale * voxel_edge_;
  hit.label = sample.cell;
  hit.instance = sample.home;
  hit.element = place.voxel;
  hit.face_normal = {};
  if (place.entry_axis >= 0) {
    const std::size_t a = std::size_t(place.entry_axis);
    hit.face_normal[a] = ray.rises(a) ? -1 : 1;
  }
}

Vec3 CellScene::shading_normal(const Hit& hit) const {
  Vec3 sum;
  constexpr std::int64_t r = kNormalRadius;
  for (std::int64_t z = -r; z <= r; ++z)
    for (std::int64_t y = -r; y <= r; ++y)
      for (std::int64_t x = -r; x <= r; ++x) {
        const std::int64_t d2 = x * x + y * y + z * z;
        if (d2 == 0 || d2 > r * r) continue;
        const Voxel v{hit.element[0] + x, hit.element[1] + y, hit.element[2] + z};
        if (in_grid(v) && sample(v).inside) continue;
        sum = sum + Vec3{double(x), double(y), double(z)} / double(d2);
      }
  // Walls thinner than the neighbourhood can balance out; the face that was entered is right then.
  const double l = length(sum);
  return l > 1e-3 ? sum / l : hit.face_normal;
}

}  // namespace mesocell
