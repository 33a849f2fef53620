#include "sdk/trace/cell_scene.h"

#include <algorithm>

#include "sdk/core/gradient_kernel.h"
#include "sdk/core/srgb.h"
#include "sdk/trace/reach.h"

namespace mesocell {
namespace {

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace

CellScene::CellScene(const CellObject& object)
    : tile_(object.tile),
      box_{to_vec3(object.grid.box_min), to_vec3(object.box_max())},
      voxel_edge_(object.grid.voxel_edge),
      inside_(object.tile, object.membership) {
  for (std::size_t a = 0; a < 3; ++a) {
    resolution_[a] = object.tile.resolution[a];
    tiles_[a] = object.grid.tiles[a];
    size_[a] = std::int64_t{resolution_[a]} * tiles_[a];
  }
  if (object.color) color_ = *object.color;
  if (object.cell_colors) cell_colors_ = object.cell_colors->colors;
  if (object.instance_colors) instance_colors_ = object.instance_colors->colors;
  if (!instance_colors_.empty()) {
    membership_ = object.membership;
    std::uint64_t count = 0;
    for (std::uint64_t t = 0; t < membership_.entries.size(); ++t) {
      first_instance_.push_back(count);
      for (std::uint32_t c = 1; c <= membership_.cell_count; ++c)
        count += membership_.tag(t, c) == Tag::kInside;
    }
  }
  voxel_reach_ = instance_reach(tile_);
  tile_reach_.resize(inside_.entries().size());
  std::transform(inside_.entries().begin(), inside_.entries().end(), tile_reach_.begin(),
                 [](std::uint32_t entry) { return std::uint8_t(entry == InsidePieces::kNone ? 255 : 0); });
  chebyshev_transform(tile_reach_, object.grid.tiles, Border::kOpen);
  bool filled = true;
  for (std::uint64_t i = 0; i < tile_.voxel_count() && filled; ++i) filled = tile_.id(i) != 0;
  if (!filled) return;
  solid_reach_.resize(tile_reach_.size());
  std::transform(inside_.entries().begin(), inside_.entries().end(), solid_reach_.begin(),
                 [](std::uint32_t entry) { return std::uint8_t(entry == InsidePieces::kAll ? 255 : 0); });
  chebyshev_transform(solid_reach_, object.grid.tiles, Border::kOpen);
}

std::uint64_t CellScene::memory_bytes() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof(*this) + bytes(tile_.voxel_ids) + bytes(tile_.pieces) + inside_.memory_bytes() +
         bytes(color_.voxels) + bytes(cell_colors_) + bytes(instance_colors_) + bytes(first_instance_) +
         bytes(membership_.entries) + bytes(membership_.blocks) + bytes(voxel_reach_) + bytes(tile_reach_) +
         bytes(solid_reach_);
}

double CellScene::tile_edge() const { return *std::max_element(resolution_.begin(), resolution_.end()); }

void CellScene::tiles_around(const Voxel& tile, std::int64_t reach, Voxel& low, Voxel& high) const {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = (tile[a] - reach + 1) * resolution_[a];
    high[a] = (tile[a] + reach) * resolution_[a];
  }
}

bool CellScene::empty_around(const Voxel& tile, Voxel& low, Voxel& high) const {
  const std::int64_t reach = tile_reach_[tile_index(tile)];
  if (reach == 0) return false;
  tiles_around(tile, reach, low, high);
  return true;
}

bool CellScene::empty_box(const Voxel& v, Voxel& low, Voxel& high) const {
  const Voxel tile = tile_of(v);
  if (empty_around(tile, low, high)) return true;
  const std::uint64_t i = in_tile(v, tile);
  if (inside_.has(inside_.entry(tile_index(tile)), tile_.id(i))) return false;
  const std::int64_t reach = voxel_reach_[i];
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

void CellScene::set_hit(const WalkRay& ray, const WalkPlace& place, Hit& hit) const {
  const Voxel tile = tile_of(place.voxel);
  const Piece& piece = tile_.pieces[tile_.id(in_tile(place.voxel, tile)) - 1];
  hit.t = place.t * ray.scale * voxel_edge_;
  hit.label = piece.cell;
  hit.instance =
      std::int64_t(tile_index({tile[0] + piece.home[0], tile[1] + piece.home[1], tile[2] + piece.home[2]}));
  hit.element = place.voxel;
  hit.face_normal = {};
  hit.on_cut = false;
  if (place.entry_axis >= 0) {
    const std::size_t a = std::size_t(place.entry_axis);
    hit.face_normal[a] = ray.rises(a) ? -1 : 1;
  }
}

Vec3 CellScene::shading_normal(const Hit& hit) const {
  Vec3 sum;
  for (const KernelVoxel& n : gradient_kernel()) {
    const Voxel v{hit.element[0] + n.offset[0], hit.element[1] + n.offset[1], hit.element[2] + n.offset[2]};
    if (!in_grid(v) || !inside(v)) sum = sum + n.pull;
  }
  // Walls thinner than the neighbourhood can balance out; the face that was entered is right then.
  const double l = length(sum);
  return l > 1e-3 ? sum / l : hit.face_normal;
}

bool CellScene::inside_point(Vec3 point) const {
  const Vec3 p = (point - box_.min) / voxel_edge_;
  Voxel v{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(p[a] >= 0 && p[a] < double(size_[a]))) return false;
    v[a] = std::int64_t(p[a]);
  }
  return inside(v);
}

void CellScene::solid_box(const Voxel& v, Voxel& low, Voxel& high) const {
  const Voxel tile = tile_of(v);
  if (!solid_reach_.empty() && solid_reach_[tile_index(tile)] > 0) {
    tiles_around(tile, solid_reach_[tile_index(tile)], low, high);
    // Unlike what is empty, what is solid ends with the grid.
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max<std::int64_t>(low[a], 0);
      high[a] = std::min(high[a], size_[a]);
    }
    return;
  }
  const std::int64_t reach = voxel_reach_[in_tile(v, tile)];
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = v[a] - reach;
    high[a] = v[a] + reach + 1;
  }
}

Vec3 CellScene::color(const Hit& hit, Vec3 point) const {
  Vec3 color{1, 1, 1};
  if (!cell_colors_.empty()) color = srgb_to_linear(cell_colors_[hit.label - 1]);
  if (!instance_colors_.empty()) {
    const std::uint64_t home = std::uint64_t(hit.instance);
    std::uint64_t i = first_instance_[home];
    for (std::uint32_t c = 1; c < hit.label; ++c) i += membership_.tag(home, c) == Tag::kInside;
    color = times(color, srgb_to_linear(instance_colors_[i]));
  }
  if (color_.voxels.empty()) return color;
  // The point's share of its tile, held to the voxel that was hit: rounding may put it just beyond.
  const Vec3 p = (point - box_.min) / voxel_edge_;
  std::array<std::uint64_t, 3> at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = std::clamp(p[a], double(hit.element[a]), double(hit.element[a]) + 1);
    const std::int64_t tile = hit.element[a] / resolution_[a];
    const double share = (x - double(tile * resolution_[a])) / resolution_[a];
    at[a] = std::min(std::uint64_t(share * color_.resolution[a]), std::uint64_t{color_.resolution[a]} - 1);
  }
  const std::uint64_t i = at[0] + color_.resolution[0] * (at[1] + color_.resolution[1] * at[2]);
  return times(color, srgb_to_linear(color_.voxels[i]));
}

}  // namespace mesocell
