#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "format/api.h"

/// The maps of a cell object as they stand in memory. Their bytes are described in spec/mesocell-1.md.
namespace mesocell MESOCELL_API {

using Index3 = std::array<std::uint32_t, 3>;

/// The grid of tiles in object space. Voxels are cubes; a tile is `tile resolution` voxels. [spec 4.1]
struct GridLayout {
  std::array<double, 3> box_min{};  ///< minimum corner of tile (0,0,0), metres
  double voxel_edge = 0;            ///< metres
  Index3 tiles{};                   ///< tiles along x, y, z

  [[nodiscard]] std::uint64_t tile_count() const { return std::uint64_t{tiles[0]} * tiles[1] * tiles[2]; }
  /// Index of a tile, x fastest.
  [[nodiscard]] std::uint64_t tile_index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + std::uint64_t{tiles[0]} * (y + std::uint64_t{tiles[1]} * z);
  }
  bool operator==(const GridLayout&) const = default;
};

/// The part of a cell instance that lies in one tile: which cell, and where the instance's home tile is. The
/// home tile holds the first voxel of the instance in storage order. [spec 4.2]
struct Piece {
  std::uint16_t cell = 0;             ///< 1…cell_count
  std::array<std::int8_t, 3> home{};  ///< home tile minus the tile that holds the piece, in tiles
  bool operator==(const Piece&) const = default;
};

/// A tile: for every voxel the id of its piece, 0 where the tile is empty. [spec 4.2]
struct TileMap {
  Index3 resolution{};  ///< voxels along x, y, z; 4…1024 each
  std::uint32_t cell_count = 0;
  std::vector<Piece> pieces;            ///< piece id k is pieces[k - 1]; ascending by (cell, home z, y, x)
  std::uint32_t id_bytes = 1;           ///< 1, 2 or 4: the least that holds pieces.size()
  std::vector<std::uint8_t> voxel_ids;  ///< voxel_count() ids of id_bytes each, little-endian, x fastest

  [[nodiscard]] std::uint64_t voxel_count() const {
    return std::uint64_t{resolution[0]} * resolution[1] * resolution[2];
  }
  [[nodiscard]] std::uint64_t voxel_index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + std::uint64_t{resolution[0]} * (y + std::uint64_t{resolution[1]} * z);
  }
  /// Piece id of voxel `i`, 0 where empty.
  [[nodiscard]] std::uint32_t id(std::uint64_t i) const {
    const std::uint8_t* p = voxel_ids.data() + i * id_bytes;
    std::uint32_t v = p[0];
    if (id_bytes >= 2) v |= std::uint32_t{p[1]} << 8;
    if (id_bytes == 4) v |= std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
    return v;
  }
  [[nodiscard]] static std::uint32_t id_bytes_for(std::size_t piece_count) {
    return piece_count <= 0xff ? 1 : piece_count <= 0xffff ? 2 : 4;
  }
  bool operator==(const TileMap&) const = default;
};

/// Membership of a cell instance in the basic mesh. [spec 4.3]
enum class Tag : std::uint8_t { kOutside = 0, kInside = 1, kIntersected = 2 };

/// The rule by which tags were found. [spec 4.3]
enum class MembershipRule : std::uint8_t { kCentre = 0, kConservative = 1 };

/// One tag for every cell instance whose home tile is in the grid. [spec 4.3]
struct MembershipMap {
  static constexpr std::uint32_t kFirstBlock = 3;

  MembershipRule rule = MembershipRule::kCentre;
  Index3 tiles{};
  std::uint32_t cell_count = 0;
  /// One entry a tile, x fastest: 0, 1, 2 where all its instances carry that tag, else kFirstBlock + block.
  std::vector<std::uint32_t> entries;
  /// Tags of the mixed tiles, block_bytes() each: cell c is at bits 2·((c-1) mod 4) of byte (c-1) / 4.
  std::vector<std::uint8_t> blocks;

  [[nodiscard]] std::size_t block_bytes() const { return (std::size_t{cell_count} + 3) / 4; }
  /// Tag of cell `cell` (1…cell_count) whose home is tile `tile`.
  [[nodiscard]] Tag tag(std::uint64_t tile, std::uint32_t cell) const {
    assert(cell >= 1 && cell <= cell_count);
    const std::uint32_t entry = entries[static_cast<std::size_t>(tile)];
    if (entry < kFirstBlock) return static_cast<Tag>(entry);
    const std::size_t at = std::size_t{entry - kFirstBlock} * block_bytes() + (cell - 1) / 4;
    return static_cast<Tag>(blocks[at] >> (2 * ((cell - 1) % 4)) & 3);
  }
  bool operator==(const MembershipMap&) const = default;
};

/// How many cell instances carry each tag; they sum to cells × tiles.
struct InstanceCounts {
  std::uint64_t inside = 0, outside = 0, intersected = 0;
  bool operator==(const InstanceCounts&) const = default;
};
[[nodiscard]] InstanceCounts count_instances(const MembershipMap& membership);

/// An sRGB color, 8 bits a channel.
using Rgb8 = std::array<std::uint8_t, 3>;

/// A solid texture of the tile: color voxel (i, j, k) of `resolution` covers its share of the tile, and it
/// repeats with the tile. [spec 4.5]
struct ColorMap {
  Index3 resolution{};       ///< 1…1024 each
  std::vector<Rgb8> voxels;  ///< x fastest
  float max_error = 0.5f;    ///< see ColorList
  bool operator==(const ColorMap&) const = default;
};

/// Colors of cells or instances, in their order.
struct ColorList {
  std::vector<Rgb8> colors;
  /// How far a channel is at most from what the author gave, in steps of 1/255. [spec 2.7]
  float max_error = 0.5f;
  bool operator==(const ColorList&) const = default;
};

/// Unit normals at the tile's boundary voxels: those that are not empty and have one of 26 neighbours, around
/// the torus, that is empty or of another instance. Octahedral, 2 × 8 bits. [spec 4.8]
struct NormalMap {
  std::vector<std::array<std::uint8_t, 2>> normals;  ///< one a boundary voxel, in storage order
  /// The greatest angle to what the author gave. [spec 2.7]
  float max_error_degrees = 0.645f;
  bool operator==(const NormalMap&) const = default;
};

/// The basic mesh as a compressed bitstream, which nothing here looks into: decoders of such are to be kept
/// from untrusted bytes, or in processes of their own. [spec 4.10]
struct BasicMesh {
  std::vector<std::byte> draco;  ///< a Draco bitstream of a triangle mesh, metres
  std::uint32_t vertices = 0;    ///< it has, at least 3
  std::uint32_t triangles = 0;   ///< at least 1
  /// How far a vertex is at most from where the author had it, metres. [spec 2.7]
  float max_error = 0;
  bool operator==(const BasicMesh&) const = default;
};

/// Colors at the surface, finer than one an instance. A tile that has any has a *brick*, which divides the
/// tile evenly into color voxels; a color voxel may have a color. A color stands for that of the instance,
/// for all tile voxels whose centre is in its color voxel. [spec 4.11]
struct SurfaceColors {
  static constexpr std::uint32_t kNoBrick = 0xffffffff;
  static constexpr std::uint32_t kMaxResolution = 32;

  Index3 resolution{};  ///< color voxels of a tile along x, y, z; each 1…32 and at most the tile's
  /// One a tile, x fastest: its brick, counted up, or kNoBrick. At least one tile has a brick.
  std::vector<std::uint32_t> entries;
  /// mask_bytes() a brick: bit v mod 8 of byte v / 8 is set where color voxel v, x fastest, has a color. At
  /// least one is set.
  std::vector<std::uint8_t> masks;
  std::vector<std::uint32_t> first;  ///< one a brick: where its colors begin
  std::vector<Rgb8> colors;          ///< by brick, then by color voxel
  float max_error = 0.5f;            ///< see ColorList

  [[nodiscard]] std::size_t voxels_per_brick() const {
    return std::size_t{resolution[0]} * resolution[1] * resolution[2];
  }
  [[nodiscard]] std::size_t mask_bytes() const { return (voxels_per_brick() + 7) / 8; }
  /// The color voxel, x fastest, of the tile voxel at `voxel` of a tile of `tile_resolution`.
  [[nodiscard]] std::size_t color_voxel(const Index3& voxel, const Index3& tile_resolution) const {
    const auto along = [&](std::size_t a) {
      return std::size_t{(2 * voxel[a] + 1) * resolution[a] / (2 * tile_resolution[a])};
    };
    return along(0) + resolution[0] * (along(1) + resolution[1] * along(2));
  }
  /// The color of color voxel `v` of tile `tile`; null if it has none.
  [[nodiscard]] const Rgb8* find(std::uint64_t tile, std::size_t v) const;
  bool operator==(const SurfaceColors&) const = default;
};

/// A cell object: the union of its INSIDE cell instances. The color of a point is the product, in linear
/// light, of its color in the tile, that of its cell and that of its instance or, where it has one, its
/// surface color instead.
struct CellObject {
  GridLayout grid;
  TileMap tile;
  MembershipMap membership;
  std::optional<ColorMap> color;         ///< absent: white
  std::optional<ColorList> cell_colors;  ///< one a cell; absent: white
  std::optional<ColorList>
      instance_colors;  ///< one an INSIDE instance, by home tile, then cell; absent: white
  std::optional<SurfaceColors> surface_colors;  ///< absent: nowhere
  std::optional<NormalMap> normals;
  std::optional<BasicMesh> basic_mesh;
  /// Free text, UTF-8, ascending by key, keys unique.
  std::vector<std::pair<std::string, std::string>> metadata;
  bool operator==(const CellObject&) const = default;

  /// Maximum corner of what the tiles cover, metres.
  [[nodiscard]] std::array<double, 3> box_max() const {
    std::array<double, 3> m{};
    for (std::size_t a = 0; a < 3; ++a)
      m[a] = grid.box_min[a] + double(grid.tiles[a]) * double(tile.resolution[a]) * grid.voxel_edge;
    return m;
  }
};

/// Voxels of INSIDE instances in the whole object.
[[nodiscard]] std::uint64_t count_inside_voxels(const CellObject& object);

/// Metres³ of INSIDE instances.
[[nodiscard]] double inside_volume(const CellObject& object);

}  // namespace mesocell
