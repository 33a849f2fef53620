#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"
#include "sdk/trace/inside_pieces.h"
#include "sdk/trace/packets.h"
#include "sdk/trace/tile_blocks.h"
#include "sdk/trace/walk.h"

namespace mesocell {

/// A cell object prepared for tracing: its maps, and how far a ray may go at once. Thread safety: const.
class CellScene {
 public:
  explicit CellScene(const CellObject& object);

  CellScene(const CellScene&) = delete;
  CellScene& operator=(const CellScene&) = delete;

  /// Whether voxel `v` of the grid is of an INSIDE instance.
  [[nodiscard]] bool inside(const Voxel& v) const {
    const Voxel tile = tile_of(v);
    const std::uint32_t entry = inside_.entry(tile_index(tile));
    return entry != InsidePieces::kNone && inside_.has(entry, blocks_.id_at(in_tile(v, tile)));
  }

  /// A box of voxels [low, high) around voxel `v` of the grid, none of which is INSIDE, as large as is known
  /// in the directions of an octant. False if `v` itself is INSIDE.
  [[nodiscard]] bool empty_box(const Voxel& v, unsigned octant, Voxel& low, Voxel& high) const;

  /// The empty tiles upon `v` in the directions of an octant, as a box of voxels; false if the tile of `v` is
  /// not empty.
  [[nodiscard]] bool empty_tiles(const Voxel& v, unsigned octant, Voxel& low, Voxel& high) const;

  [[nodiscard]] bool in_grid(const Voxel& v) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < 0 || v[a] >= size_[a]) return false;
    return true;
  }
  /// Whether a point, in metres, is in a voxel of an INSIDE instance.
  [[nodiscard]] bool inside_point(Vec3 point) const;

  /// A box of voxels [low, high) around voxel `v`, which is INSIDE, all of which are.
  void solid_box(const Voxel& v, unsigned octant, Voxel& low, Voxel& high) const;

  /// What packets of rays look up; false if the scene is too large for them.
  [[nodiscard]] bool packets(PacketScene& out) const;

  /// Color of a point in the voxel of a hit; linear light.
  [[nodiscard]] Vec3 color(const Hit& hit, Vec3 point) const;

  /// Voxels along x, y, z.
  [[nodiscard]] const Voxel& size() const { return size_; }
  /// Longest edge of a tile, voxels.
  [[nodiscard]] double tile_edge() const;

  [[nodiscard]] Ray to_voxels(const Ray& ray) const;
  [[nodiscard]] double voxel_edge() const { return voxel_edge_; }
  [[nodiscard]] Box3 object_box() const { return box_; }
  [[nodiscard]] std::uint64_t memory_bytes() const;

  /// Fills a hit on an INSIDE voxel. `t` in voxels.
  void set_hit(const WalkRay& ray, const WalkPlace& place, Hit& hit) const;

  /// What a hit of a stream leaves out.
  [[nodiscard]] Hit details(const StreamHit& hit) const;

  /// Outward normal at a hit: the direction in which solid turns to empty in the voxels around it.
  [[nodiscard]] Vec3 shading_normal(const Hit& hit) const;

 private:
  /// The surface color of a voxel of the grid; null if it has none.
  [[nodiscard]] const Rgb8* surface_color(const Voxel& v) const;
  /// Fills label and instance of a hit from its element.
  void set_instance(Hit& hit) const;
  void find_empty_tiles(const Index3& tiles);
  void find_parts();

  /// What rays see of a tile's voxel: its place in the mirrored tile.
  [[nodiscard]] std::array<std::uint32_t, 3> mirrored(const std::array<std::uint32_t, 3>& l,
                                                      unsigned octant) const;
  /// The box upward from `m`, in the mirrored tile, in which all voxels are of one instance; returns its
  /// piece.
  std::uint32_t same_instance_to(const std::array<std::uint32_t, 3>& m, unsigned octant,
                                 std::array<std::uint32_t, 3>& to) const;

  // Coordinates of a grid are below 2^30: 32-bit divisions take a third of the time of 64-bit ones.
  [[nodiscard]] Voxel tile_of(const Voxel& v) const {
    return {std::uint32_t(v[0]) / resolution_[0], std::uint32_t(v[1]) / resolution_[1],
            std::uint32_t(v[2]) / resolution_[2]};
  }
  [[nodiscard]] std::uint64_t tile_index(const Voxel& t) const {
    return std::uint64_t(t[0] + tiles_[0] * (t[1] + tiles_[1] * t[2]));
  }
  [[nodiscard]] std::array<std::uint32_t, 3> in_tile(const Voxel& v, const Voxel& tile) const {
    return {std::uint32_t(v[0] - tile[0] * resolution_[0]), std::uint32_t(v[1] - tile[1] * resolution_[1]),
            std::uint32_t(v[2] - tile[2] * resolution_[2])};
  }

  Box3 box_;
  double voxel_edge_;
  std::array<std::uint32_t, 3> resolution_{};
  Voxel tiles_{}, size_{};
  TileBlocks blocks_;
  InsidePieces inside_;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> labels_;        ///< of piece ids, 0 where empty
  std::vector<std::uint32_t> tile_records_;  ///< see tile_record.h
  /// For each set of pieces, octant and part of the mirrored tile the edge, in parts, of the cube upward from
  /// it that has nothing INSIDE, 0…4; 64 to an octant.
  std::vector<std::uint8_t> parts_;
  std::vector<Bits64> occupied_parts_;  ///< for each set of pieces the parts with INSIDE voxels
  /// For each tile: 0 if some of its voxels are not INSIDE, else all tiles nearer than this are solid as
  /// well. Empty if the tile has empty voxels.
  std::vector<std::uint8_t> solid_reach_;
  ColorMap color_;  ///< no voxels: white
  std::vector<Rgb8> cell_colors_, instance_colors_;
  SurfaceColors surface_colors_;  ///< no colors: nowhere
  /// For each tile, how many INSIDE instances have homes before it; only where instances have colors.
  std::vector<std::uint64_t> first_instance_;
  MembershipMap membership_;  ///< only where instances have colors
};

}  // namespace mesocell
