#include "converters/vdb/vdb_export.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "converters/vdb/object_metadata.h"
#include "converters/vdb/object_voxels.h"
#include "converters/vdb/vdb_file.h"
#include "sdk/core/parallel.h"
#include "sdk/trace/cell_scene.h"

namespace mesocell {
namespace {

constexpr std::int32_t kBand = 3;
constexpr std::size_t kLeafVoxels = SparseVolume::kLeafVoxels;

/// Voxels [low, high).
struct VoxelRange {
  VoxelCoord low{}, high{};
  [[nodiscard]] bool has(const VoxelCoord& v) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < low[a] || v[a] >= high[a]) return false;
    return true;
  }
};

/// Adds what stands in the leaf at `origin` to a part of the grid: a leaf, a tile or nothing.
using AddLeaf =
    std::function<void(const VoxelCoord& origin, ObjectVoxels::Reader& reader, SparseVolume& part)>;

/// Fills a grid leaf by leaf, layers of them at once on several threads.
Status fill_grid(const ObjectVoxels& voxels, const VoxelRange& range, const AddLeaf& add,
                 const VdbExportOptions& options, const Progress* progress, SparseVolume& grid) {
  VoxelCoord first, count;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = range.low[a] >> 3;
    count[a] = ((range.high[a] + 7) >> 3) - first[a];
  }
  std::vector<SparseVolume> layers(std::size_t(std::max(count[2], 0)));
  std::atomic<std::uint64_t> leaves = 0, done = 0;
  const std::uint64_t most = options.max_voxels / kLeafVoxels;
  const bool finished = parallel_for(
      layers.size(), options.threads,
      [&](std::size_t z, unsigned) {
        ObjectVoxels::Reader reader(voxels);
        SparseVolume& part = layers[z];
        part.type = grid.type;
        for (std::int32_t y = 0; y < count[1]; ++y) {
          if (leaves > most || (progress && progress->cancelled())) return;
          const std::size_t before = part.leaves.size();
          for (std::int32_t x = 0; x < count[0]; ++x)
            add({8 * (first[0] + x), 8 * (first[1] + y), 8 * (first[2] + std::int32_t(z))}, reader, part);
          leaves += part.leaves.size() - before;
        }
        ++done;
      },
      progress, "volume");
  if (!finished || (progress && progress->cancelled())) return Error{ErrorCode::kCancelled, "interrupted"};
  if (leaves > most) {
    const double estimate =
        double(leaves) * kLeafVoxels * double(layers.size()) / double(std::max<std::uint64_t>(done, 1));
    return Error{ErrorCode::kLimit,
                 "grid '" + grid.name + "' would take about " +
                     std::to_string(std::uint64_t(estimate * 1e-6)) + " million voxels, over the limit of " +
                     std::to_string(options.max_voxels) + "; take a box of tiles (--region)"};
  }
  for (SparseVolume& layer : layers) {
    grid.leaves.insert(grid.leaves.end(), layer.leaves.begin(), layer.leaves.end());
    grid.tiles.insert(grid.tiles.end(), layer.tiles.begin(), layer.tiles.end());
    grid.floats.insert(grid.floats.end(), layer.floats.begin(), layer.floats.end());
    grid.ints.insert(grid.ints.end(), layer.ints.begin(), layer.ints.end());
    layer = {};
  }
  return {};
}

/// Half-distances squared, from the centre of a voxel to the nearest cube of a voxel of a kind that is up to
/// kBand away along each axis: (2 k - 1)² for one k voxels off, and so many that it is beyond the band if
/// there is none.
class NearestCubes {
 public:
  static constexpr std::int32_t kReach = kBand, kEdge = 8 + 2 * kReach;
  static constexpr std::int32_t kBeyond = (2 * kBand) * (2 * kBand);
  using Cells = std::array<std::uint8_t, std::size_t(kEdge* kEdge* kEdge)>;  ///< the leaf and what is around

  /// Distances of the leaf's voxels to those that are `kind`.
  void find(const Cells& cells, std::uint8_t kind, std::array<std::int32_t, kLeafVoxels>& out) {
    const auto term = [](std::int32_t k) { return k == 0 ? 0 : (2 * k - 1) * (2 * k - 1); };
    for (std::int32_t z = 0; z < kEdge; ++z)
      for (std::int32_t y = 0; y < kEdge; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
          std::int32_t least = kBeyond;
          for (std::int32_t k = -kReach; k <= kReach; ++k)
            if (cells[index(x + kReach + k, y, z)] == kind) least = std::min(least, term(std::abs(k)));
          along_x_[std::size_t(x + 8 * (y + kEdge * z))] = least;
        }
    for (std::int32_t z = 0; z < kEdge; ++z)
      for (std::int32_t y = 0; y < 8; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
          std::int32_t least = kBeyond;
          for (std::int32_t k = -kReach; k <= kReach; ++k)
            least = std::min(least,
                             along_x_[std::size_t(x + 8 * (y + kReach + k + kEdge * z))] + term(std::abs(k)));
          along_y_[std::size_t(x + 8 * (y + 8 * z))] = least;
        }
    for (std::int32_t z = 0; z < 8; ++z)
      for (std::int32_t i = 0; i < 64; ++i) {
        std::int32_t least = kBeyond;
        for (std::int32_t k = -kReach; k <= kReach; ++k)
          least = std::min(least, along_y_[std::size_t(i + 64 * (z + kReach + k))] + term(std::abs(k)));
        out[std::size_t(i + 64 * z)] = least;
      }
  }
  static std::size_t index(std::int32_t x, std::int32_t y, std::int32_t z) {
    return std::size_t(x + kEdge * (y + kEdge * z));
  }

 private:
  std::array<std::int32_t, std::size_t(8 * kEdge * kEdge)> along_x_{};
  std::array<std::int32_t, std::size_t(64 * kEdge)> along_y_{};
};

AddLeaf level_set_leaf(const VoxelRange& range, double edge) {
  return [range, edge](const VoxelCoord& origin, ObjectVoxels::Reader& reader, SparseVolume& part) {
    NearestCubes::Cells cells;
    std::size_t inside = 0, i = 0;
    VoxelCoord v;
    constexpr std::int32_t kReach = NearestCubes::kReach, kEdge = NearestCubes::kEdge;
    for (v[2] = origin[2] - kReach; v[2] < origin[2] - kReach + kEdge; ++v[2])
      for (v[1] = origin[1] - kReach; v[1] < origin[1] - kReach + kEdge; ++v[1])
        for (v[0] = origin[0] - kReach; v[0] < origin[0] - kReach + kEdge; ++v[0], ++i) {
          cells[i] = range.has(v) && reader.at(v).tag == Tag::kInside;
          inside += cells[i];
        }
    const float band = float(kBand * edge);
    if (inside == 0) return;
    if (inside == cells.size()) {
      part.tiles.push_back({origin, 3, false, {-double(band), 0, 0}});
      return;
    }
    std::array<std::int32_t, kLeafVoxels> to_inside, to_outside;
    NearestCubes nearest;
    nearest.find(cells, 1, to_inside);
    nearest.find(cells, 0, to_outside);
    VolumeLeaf leaf{origin, {}};
    bool any = false;
    std::array<float, kLeafVoxels> values;
    for (std::size_t k = 0; k < kLeafVoxels; ++k) {
      const bool in = to_inside[k] == 0;
      const std::int32_t square = in ? to_outside[k] : to_inside[k];
      const float distance =
          square >= NearestCubes::kBeyond ? band : float(std::sqrt(double(square)) / 2 * edge);
      values[k] = in ? -distance : distance;
      if (square >= NearestCubes::kBeyond) continue;
      any = true;
      leaf.active[k / 64] |= std::uint64_t{1} << (k % 64);
    }
    if (!any) {
      // All of it is on one side.
      if (values[0] < 0) part.tiles.push_back({origin, 3, false, {-double(band), 0, 0}});
      return;
    }
    part.leaves.push_back(leaf);
    part.floats.insert(part.floats.end(), values.begin(), values.end());
  };
}

/// A leaf of whole numbers or floats, one for each voxel; a tile where all are the same.
AddLeaf number_leaf(const VoxelRange& range, bool ints,
                    const std::function<std::uint32_t(const ObjectVoxels::Found&)>& number) {
  return [=](const VoxelCoord& origin, ObjectVoxels::Reader& reader, SparseVolume& part) {
    VolumeLeaf leaf{origin, {}};
    std::array<std::uint32_t, kLeafVoxels> values;
    std::size_t set = 0;
    for (std::int32_t k = 0; k < std::int32_t(kLeafVoxels); ++k) {
      const VoxelCoord v{origin[0] + k % 8, origin[1] + k / 8 % 8, origin[2] + k / 64};
      const std::uint32_t value = range.has(v) ? number(reader.at(v)) : 0;
      values[std::size_t(k)] = value;
      if (value == 0) continue;
      ++set;
      leaf.active[std::size_t(k / 64)] |= std::uint64_t{1} << (k % 64);
    }
    if (set == 0) return;
    if (std::all_of(values.begin(), values.end(), [&](std::uint32_t v) { return v == values[0]; })) {
      part.tiles.push_back({origin, 3, true, {double(values[0]), 0, 0}});
      return;
    }
    part.leaves.push_back(leaf);
    for (const std::uint32_t value : values)
      if (ints)
        part.ints.push_back(std::int32_t(value));
      else
        part.floats.push_back(float(value));
  };
}

AddLeaf color_leaf(const VoxelRange& range, const CellObject& object,
                   const std::shared_ptr<const CellScene>& scene) {
  const Vec3 corner = to_vec3(object.grid.box_min);
  const double edge = object.grid.voxel_edge;
  return [=](const VoxelCoord& origin, ObjectVoxels::Reader& reader, SparseVolume& part) {
    VolumeLeaf leaf{origin, {}};
    std::array<float, 3 * kLeafVoxels> values{};
    bool any = false;
    for (std::int32_t k = 0; k < std::int32_t(kLeafVoxels); ++k) {
      const VoxelCoord v{origin[0] + k % 8, origin[1] + k / 8 % 8, origin[2] + k / 64};
      if (!range.has(v)) continue;
      const ObjectVoxels::Found found = reader.at(v);
      if (found.tag != Tag::kInside) continue;
      any = true;
      leaf.active[std::size_t(k / 64)] |= std::uint64_t{1} << (k % 64);
      Hit hit;
      hit.label = found.cell;
      hit.instance = std::int64_t(found.home);
      hit.element = {v[0], v[1], v[2]};
      const Vec3 color = scene->color(hit, corner + Vec3{v[0] + 0.5, v[1] + 0.5, v[2] + 0.5} * edge);
      for (std::size_t c = 0; c < 3; ++c) values[3 * std::size_t(k) + c] = float(color[c]);
    }
    if (!any) return;
    part.leaves.push_back(leaf);
    part.floats.insert(part.floats.end(), values.begin(), values.end());
  };
}

/// The grids of one tile: its cells, and where their homes are.
std::array<SparseVolume, 2> tile_grids(const CellObject& object) {
  std::array<SparseVolume, 2> grids;
  grids[0].name = kTileGrid;
  grids[0].type = VolumeType::kInt;
  grids[0].metadata = object_metadata(object);
  grids[1].name = kHomeGrid;
  grids[1].type = VolumeType::kInt3;
  const TileMap& tile = object.tile;
  const Index3& n = tile.resolution;
  for (std::uint32_t z0 = 0; z0 < n[2]; z0 += 8)
    for (std::uint32_t y0 = 0; y0 < n[1]; y0 += 8)
      for (std::uint32_t x0 = 0; x0 < n[0]; x0 += 8) {
        VolumeLeaf leaf{{std::int32_t(x0), std::int32_t(y0), std::int32_t(z0)}, {}};
        std::array<Piece, kLeafVoxels> pieces{};
        bool any = false;
        for (std::uint32_t k = 0; k < kLeafVoxels; ++k) {
          const Index3 v{x0 + k % 8, y0 + k / 8 % 8, z0 + k / 64};
          if (v[0] >= n[0] || v[1] >= n[1] || v[2] >= n[2]) continue;
          const std::uint32_t id = tile.id(tile.voxel_index(v[0], v[1], v[2]));
          if (id == 0) continue;
          any = true;
          pieces[k] = tile.pieces[id - 1];
          leaf.active[k / 64] |= std::uint64_t{1} << (k % 64);
        }
        if (!any) continue;
        for (SparseVolume& grid : grids) grid.leaves.push_back(leaf);
        for (const Piece& piece : pieces) {
          grids[0].ints.push_back(piece.cell);
          for (const std::int8_t h : piece.home) grids[1].ints.push_back(h);
        }
      }
  return grids;
}

Status check(const CellObject& object, const VdbExportOptions& options) {
  const VdbKinds& k = options.kinds;
  if (!k.level_set && !k.fog && !k.labels && !k.colors)
    return Error{ErrorCode::kUsage, "no kind of grid to write is named"};
  if (options.tiles && k.labels)
    return Error{ErrorCode::kUsage, "labels are of all tiles, as an asset is; leave the range of tiles out"};
  if (options.tiles)
    for (std::size_t a = 0; a < 3; ++a)
      if (options.tiles->begin[a] >= options.tiles->end[a] || options.tiles->end[a] > object.grid.tiles[a])
        return Error{ErrorCode::kUsage, "the range of tiles is empty or beyond the grid's " +
                                            std::to_string(object.grid.tiles[a]) + " along an axis"};
  if (!ObjectVoxels::fits(object))
    return Error{ErrorCode::kLimit, "the grid has more than 2^23 voxels along an axis; use fewer tiles"};
  return {};
}

}  // namespace

Status export_vdb(const CellObject& object, const std::string& path, const VdbExportOptions& options,
                  VdbExportReport* report, const Progress* progress) {
  if (Status status = check(object, options); !status) return status;
  const ObjectVoxels voxels(object);
  VoxelRange range{{0, 0, 0}, voxels.size()};
  if (options.tiles)
    for (std::size_t a = 0; a < 3; ++a) {
      range.low[a] = std::int32_t(options.tiles->begin[a] * object.tile.resolution[a]);
      range.high[a] = std::int32_t(options.tiles->end[a] * object.tile.resolution[a]);
    }
  const double edge = object.grid.voxel_edge;
  const Transform to_world =
      translation(to_vec3(object.grid.box_min) + Vec3{0.5, 0.5, 0.5} * edge) * scaling({edge, edge, edge});
  std::vector<SparseVolume> grids;
  const auto add = [&](const char* name, VolumeType type, VolumeClass volume_class, double background,
                       const VoxelRange& filled, const AddLeaf& leaf) -> Status {
    SparseVolume grid;
    grid.name = name;
    grid.type = type;
    grid.volume_class = volume_class;
    grid.index_to_world = to_world;
    grid.background[0] = background;
    Status status = fill_grid(voxels, filled, leaf, options, progress, grid);
    if (status) grids.push_back(std::move(grid));
    return status;
  };
  if (options.kinds.level_set) {
    VoxelRange wide = range;
    for (std::size_t a = 0; a < 3; ++a) wide.low[a] -= kBand, wide.high[a] += kBand;
    if (Status s = add("surface", VolumeType::kFloat, VolumeClass::kLevelSet, double(float(kBand * edge)),
                       wide, level_set_leaf(range, edge));
        !s)
      return s;
    if (grids[0].leaves.empty())
      return Error{ErrorCode::kInvalidInput, "nothing is inside there, so there is no surface to write"};
  }
  using Found = ObjectVoxels::Found;
  const auto numbers = [&](const char* name, bool ints, VolumeClass volume_class, auto number) {
    return add(name, ints ? VolumeType::kInt : VolumeType::kFloat, volume_class, 0, range,
               number_leaf(range, ints, number));
  };
  if (options.kinds.fog)
    if (Status s = numbers("density", false, VolumeClass::kFog,
                           [](const Found& f) { return f.tag == Tag::kInside ? 1u : 0u; });
        !s)
      return s;
  if (options.kinds.labels) {
    if (Status s = numbers(kCellGrid, true, VolumeClass::kUnknown,
                           [](const Found& f) { return f.tag == Tag::kInside ? f.cell : 0u; });
        !s)
      return s;
    if (Status s = numbers(kMembershipGrid, true, VolumeClass::kUnknown,
                           [](const Found& f) { return std::uint32_t(f.tag); });
        !s)
      return s;
    for (SparseVolume& grid : tile_grids(object)) grids.push_back(std::move(grid));
  }
  if (options.kinds.colors)
    if (Status s = add("Cd", VolumeType::kFloat3, VolumeClass::kUnknown, 0, range,
                       color_leaf(range, object, std::make_shared<const CellScene>(object)));
        !s)
      return s;
  if (Status status = write_vdb(path, grids, options.no_clobber, {}, progress); !status) return status;
  if (!report) return {};
  *report = {};
  for (const SparseVolume& grid : grids)
    report->grids.push_back({grid.name, grid.leaves.size() * kLeafVoxels});
  std::error_code ignored;
  report->bytes = std::filesystem::file_size(path, ignored);
  if (!options.kinds.labels) report->losses.emplace_back("which cells there are, and tags");
  if (!options.kinds.colors &&
      (object.color || object.cell_colors || object.instance_colors || object.surface_colors))
    report->losses.emplace_back("colors");
  if (object.normals) report->losses.emplace_back("normals");
  if (!object.metadata.empty()) report->losses.emplace_back("metadata");
  return {};
}

}  // namespace mesocell
