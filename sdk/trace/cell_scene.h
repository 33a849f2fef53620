#pragma once

#include <cstdint>
#include <vector>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"
#include "sdk/trace/walk.h"

namespace mesocell {

/// A cell object prepared for tracing: its maps, and how far a ray may go at once. Thread safety: const.
class CellScene {
 public:
  explicit CellScene(const CellObject& object);

  /// What is at a voxel of the grid.
  struct Sample {
    std::uint32_t cell = 0;     ///< 0 in empty space
    bool inside = false;        ///< of an INSIDE instance
    std::int64_t home = 0;      ///< index of the instance's home tile, if it is inside
    std::uint64_t in_tile = 0;  ///< index of the voxel in its tile
  };
  /// `v` must be in the grid.
  [[nodiscard]] Sample sample(const Voxel& v) const { return sample_in(tile_of(v), v); }

  /// The largest known box of voxels [low, high) around voxel `v` of the grid, none of which is INSIDE. False
  /// if `v` itself is; then `sample` says of what.
  [[nodiscard]] bool empty_box(const Voxel& v, Voxel& low, Voxel& high, Sample& sample) const;

  /// The empty tiles around `v`, as a box of voxels; false if the tile of `v` is not known to be empty.
  [[nodiscard]] bool empty_tiles(const Voxel& v, Voxel& low, Voxel& high) const {
    return empty_around(tile_of(v), low, high);
  }

  [[nodiscard]] bool in_grid(const Voxel& v) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < 0 || v[a] >= size_[a]) return false;
    return true;
  }
  /// Voxels along x, y, z.
  [[nodiscard]] const Voxel& size() const { return size_; }
  /// Longest edge of a tile, voxels.
  [[nodiscard]] double tile_edge() const;

  [[nodiscard]] Ray to_voxels(const Ray& ray) const;
  [[nodiscard]] double voxel_edge() const { return voxel_edge_; }
  [[nodiscard]] Box3 object_box() const { return box_; }

  /// Fills a hit on an INSIDE voxel. `t` in voxels.
  void set_hit(const WalkRay& ray, const WalkPlace& place, const Sample& sample, Hit& hit) const;

  /// Outward normal at a hit: the direction in which solid turns to empty in the voxels around it.
  [[nodiscard]] Vec3 shading_normal(const Hit& hit) const;

 private:
  [[nodiscard]] Sample sample_in(const Voxel& tile, const Voxel& v) const;
  [[nodiscard]] bool empty_around(const Voxel& tile, Voxel& low, Voxel& high) const;
  [[nodiscard]] Voxel tile_of(const Voxel& v) const {
    return {v[0] / resolution_[0], v[1] / resolution_[1], v[2] / resolution_[2]};
  }
  [[nodiscard]] std::uint64_t tile_index(const Voxel& t) const {
    return std::uint64_t(t[0] + tiles_[0] * (t[1] + tiles_[1] * t[2]));
  }
  [[nodiscard]] bool tile_is_empty(const Voxel& tile) const;
  void measure_tiles();

  TileMap tile_;
  MembershipMap membership_;
  Box3 box_;
  double voxel_edge_;
  Voxel resolution_{}, tiles_{}, size_{};
  /// For each voxel of the tile: all voxels up to this Chebyshev distance are of the same instance, or empty.
  std::vector<std::uint8_t> voxel_reach_;
  /// For each tile: 0 if an INSIDE instance has voxels in it, else all tiles nearer than this (Chebyshev)
  /// have none.
  std::vector<std::uint8_t> tile_reach_;
};

}  // namespace mesocell
