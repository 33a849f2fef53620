#include "sdk/author/mesh_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "sdk/membership/diagnose.h"
#include "sdk/membership/scanline.h"
#include "sdk/tiles/assemble.h"

namespace mesocell {
namespace {

/// A piece's offset from its home has 8 bits in the file.
constexpr std::int64_t kMaxTiles = 100;
/// Images of all cells together; more would take gigabytes.
constexpr std::size_t kMaxImages = std::size_t{1} << 24;

/// Rows of voxels that are filled at once, along y and z.
constexpr std::uint32_t kBundle = 64;

/// A cell's mesh in voxels, moved to the corner of its own box of voxels.
struct PlacedCell {
  TriangleMesh mesh;
  std::array<std::int64_t, 3> corner{};      ///< of the box, voxels from the tile's corner
  Index3 size{};                             ///< of the box, voxels
  std::array<std::int64_t, 3> first_tile{};  ///< that the box reaches into
  Index3 tiles{};
};

/// Quotient and remainder of a voxel by the tile's edge; the remainder is not negative.
struct Wrapped {
  std::int64_t tile;
  std::uint32_t voxel;
};
Wrapped wrap(std::int64_t voxel, std::uint32_t edge) {
  const std::int64_t tile = (voxel >= 0 ? voxel : voxel - (std::int64_t{edge} - 1)) / std::int64_t{edge};
  return {tile, std::uint32_t(voxel - tile * edge)};
}

Result<PlacedCell> place(const TriangleMesh& mesh, const Index3& n, const TilePlacement& placement,
                         const std::string& name) {
  const MeshDiagnosis diagnosis = diagnose(mesh);
  if (!diagnosis.closed())
    return Error{ErrorCode::kInvalidInput, name + ": " + describe(diagnosis) + "; close it in a mesh editor",
                 "mesh-not-closed"};
  PlacedCell cell;
  cell.mesh.triangles = mesh.triangles;
  cell.mesh.vertices.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices)
    cell.mesh.vertices.push_back((v - placement.origin) / placement.voxel_edge);
  const Box3 box = bounding_box(cell.mesh);
  Vec3 corner;
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = std::floor(box.min[a]), high = std::floor(box.max[a]);
    // The negation catches what is no number.
    if (!(high - low < double(kMaxTiles) * n[a] && std::abs(low) < 0x1p40))
      return Error{ErrorCode::kLimit, name + " reaches over more than " + std::to_string(kMaxTiles) +
                                          " tiles or is too far away; use a larger tile"};
    corner[a] = low;
    cell.corner[a] = std::int64_t(low);
    cell.size[a] = std::uint32_t(high - low) + 1;
    cell.first_tile[a] = wrap(cell.corner[a], n[a]).tile;
    cell.tiles[a] =
        std::uint32_t(wrap(cell.corner[a] + cell.size[a] - 1, n[a]).tile - cell.first_tile[a]) + 1;
    if (std::abs(cell.first_tile[a]) > std::numeric_limits<std::int32_t>::max() / 2)
      return Error{ErrorCode::kLimit, name + " is too far from the tile; move it nearer"};
  }
  for (Vec3& v : cell.mesh.vertices) v = v - corner;
  return cell;
}

/// Adds the images of a cell, ascending as owners are: a voxel of tile q is moved by -q into the tile.
void add_images(const PlacedCell& cell, std::uint32_t number, std::vector<CodeOwner>& owners) {
  const auto shift = [&](std::size_t a, std::uint32_t t) {
    return std::int32_t(-(cell.first_tile[a] + std::int64_t{t}));
  };
  for (std::uint32_t z = cell.tiles[2]; z-- > 0;)
    for (std::uint32_t y = cell.tiles[1]; y-- > 0;)
      for (std::uint32_t x = cell.tiles[0]; x-- > 0;)
        owners.push_back({number, {shift(0, x), shift(1, y), shift(2, z)}});
}

/// Gives the voxels inside a cell to it; counts those that several claim, which go to the lowest code.
/// `first_code`: of the cell's images. False if cancelled.
bool fill(const PlacedCell& cell, const Index3& n, std::uint32_t first_code, const Progress* progress,
          VoxelCodes& codes, std::uint64_t& contested) {
  const Index3 block{cell.size[0], std::min(cell.size[1], kBundle), std::min(cell.size[2], kBundle)};
  const Index3 blocks{1, (cell.size[1] + block[1] - 1) / block[1], (cell.size[2] + block[2] - 1) / block[2]};
  const Scanline scanline(cell.mesh, block, blocks);
  Scanline::Scratch scratch;
  RowIntervals rows;
  const auto from_last = [&](std::size_t a, std::int64_t tile) {
    return cell.tiles[a] - 1 - std::uint32_t(tile - cell.first_tile[a]);
  };
  for (std::uint32_t bz = 0; bz < blocks[2]; ++bz)
    for (std::uint32_t by = 0; by < blocks[1]; ++by) {
      if (progress && progress->cancelled()) return false;
      scanline.bundle(by, bz, scratch, rows);
      for (std::uint32_t row = 0; row < block[1] * block[2]; ++row) {
        if (rows.row(row).empty()) continue;
        const Wrapped y = wrap(cell.corner[1] + by * block[1] + row % block[1], n[1]);
        const Wrapped z = wrap(cell.corner[2] + bz * block[2] + row / block[1], n[2]);
        const std::uint64_t tile_row = n[0] * (y.voxel + std::uint64_t{n[1]} * z.voxel);
        const std::uint32_t row_code =
            first_code + cell.tiles[0] * (from_last(1, y.tile) + cell.tiles[1] * from_last(2, z.tile));
        for (const Interval& interval : rows.row(row))
          for (std::uint32_t x = interval.begin; x < interval.end; ++x) {
            const Wrapped at = wrap(cell.corner[0] + x, n[0]);
            const std::uint32_t code = row_code + from_last(0, at.tile), old = codes.get(tile_row + at.voxel);
            if (old == 0 || code < old) codes.set(tile_row + at.voxel, code);
            contested += old != 0;
          }
      }
    }
  return true;
}

}  // namespace

TilePlacement place_tile(const Box3& box, const Index3& resolution, double size) {
  const Vec3 extent = box.extent();
  TilePlacement placement;
  if (size > 0) {
    placement.voxel_edge = size / std::max({resolution[0], resolution[1], resolution[2]});
  } else {
    for (std::size_t a = 0; a < 3; ++a)
      placement.voxel_edge = std::max(placement.voxel_edge, extent[a] / (resolution[a] - 2.0));
  }
  for (std::size_t a = 0; a < 3; ++a)
    placement.origin[a] = box.min[a] + extent[a] / 2 - placement.voxel_edge * resolution[a] / 2;
  return placement;
}

std::vector<TriangleMesh> split_into_parts(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parents = merge_identical_vertices(mesh.vertices);
  const auto root = [&](std::uint32_t v) {
    while (parents[v] != v) v = parents[v] = parents[parents[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : {t[1], t[2]}) {
      const std::uint32_t a = root(t[0]), b = root(v);
      parents[std::max(a, b)] = std::min(a, b);
    }

  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> part_of_root(mesh.vertices.size(), kNone),
      new_index(mesh.vertices.size(), kNone);
  std::vector<TriangleMesh> parts;
  for (const Triangle& t : mesh.triangles) {
    std::uint32_t& part = part_of_root[root(t[0])];
    if (part == kNone) {
      part = std::uint32_t(parts.size());
      parts.emplace_back();
    }
    TriangleMesh& to = parts[part];
    Triangle moved{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& index = new_index[t[k]];
      if (index == kNone) {
        index = std::uint32_t(to.vertices.size());
        to.vertices.push_back(mesh.vertices[t[k]]);
      }
      moved[k] = index;
    }
    to.triangles.push_back(moved);
  }
  return parts;
}

Result<TileMap> make_mesh_tile(std::span<const TriangleMesh> cells, const Index3& resolution,
                               const TilePlacement& placement, unsigned threads, TileReport* report,
                               const Progress* progress) {
  if (!(placement.voxel_edge > 0) || !std::isfinite(placement.voxel_edge) || !is_finite(placement.origin))
    return Error{ErrorCode::kUsage, "the tile has no size; give the edge of the tile, above 0"};
  if (cells.size() > 0xffff)
    return Error{ErrorCode::kLimit, "there are " + std::to_string(cells.size()) +
                                        " parts, and a tile has room for 65535 cells; use fewer"};
  std::vector<PlacedCell> placed;
  std::vector<CodeOwner> owners;
  std::vector<std::uint32_t> first_code;
  for (const TriangleMesh& mesh : cells) {
    const std::uint32_t number = std::uint32_t(placed.size() + 1);
    Result<PlacedCell> cell =
        place(mesh, resolution, placement, cells.size() == 1 ? "the mesh" : "part " + std::to_string(number));
    if (!cell) return cell.error();
    first_code.push_back(std::uint32_t(owners.size() + 1));
    if (owners.size() + std::size_t{cell->tiles[0]} * cell->tiles[1] * cell->tiles[2] > kMaxImages)
      return Error{ErrorCode::kLimit, "the meshes reach over too many tiles; use a larger tile"};
    add_images(*cell, number, owners);
    placed.push_back(std::move(*cell));
  }

  const std::uint64_t voxels = std::uint64_t{resolution[0]} * resolution[1] * resolution[2];
  VoxelCodes codes(voxels, owners.size());
  std::uint64_t contested = 0;
  for (std::size_t c = 0; c < placed.size(); ++c)
    if (!fill(placed[c], resolution, first_code[c], progress, codes, contested))
      return Error{ErrorCode::kCancelled, "cancelled"};
  bool any = false;
  for (std::uint64_t i = 0; i < voxels && !any; ++i) any = codes.get(i) != 0;
  if (!any)
    return Error{ErrorCode::kInvalidInput,
                 "no voxel's centre is inside a mesh; use a higher resolution or a smaller tile"};
  TileMap tile = assemble_tile(resolution, codes, owners, threads);
  if (report) {
    report->contested_voxels = contested;
    report->dropped_cells = std::uint32_t(placed.size()) - tile.cell_count;
  }
  return tile;
}

}  // namespace mesocell
