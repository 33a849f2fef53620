#include "sdk/trace/nearest_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kMaxRuns = std::uint64_t{1} << 24;

/// Calls `run(id, x0, x1, y, z)` for the rows' runs of one piece.
template <class OnRun>
void visit_runs(const TileMap& tile, OnRun&& run) {
  for (std::uint32_t z = 0; z < tile.resolution[2]; ++z)
    for (std::uint32_t y = 0; y < tile.resolution[1]; ++y) {
      const std::uint64_t row = tile.voxel_index(0, y, z);
      for (std::uint32_t x = 0, end = 0; x < tile.resolution[0]; x = end) {
        const std::uint32_t id = tile.id(row + x);
        for (end = x + 1; end < tile.resolution[0] && tile.id(row + end) == id;) ++end;
        if (id != 0) run(id, x, end, y, z);
      }
    }
}

/// Blocks of 2^level tiles along an axis.
std::uint32_t blocks_along(std::uint32_t tiles, std::size_t level) {
  return std::uint32_t((tiles + (std::uint64_t{1} << level) - 1) >> level);
}

}  // namespace

Result<NearestCell> NearestCell::make(const CellObject& object, unsigned threads) {
  std::uint64_t count = 0;
  visit_runs(object.tile, [&](auto...) { ++count; });
  if (count > kMaxRuns)
    return Error{ErrorCode::kLimit, "the tile has " + std::to_string(count) +
                                        " runs of voxels; distances are measured up to " +
                                        std::to_string(kMaxRuns) + ", use a tile of lower resolution"};
  InsidePieces inside(object.tile, object.membership);
  if (std::all_of(inside.entries().begin(), inside.entries().end(),
                  [](std::uint32_t entry) { return entry == InsidePieces::kNone; }))
    return Error{ErrorCode::kInvalidInput,
                 "no cell is inside, so there is nothing to measure the distance of"};
  std::vector<std::vector<Run>> runs(object.tile.pieces.size());
  visit_runs(object.tile,
             [&](std::uint32_t id, auto... ends) { runs[id - 1].push_back({std::uint16_t(ends)...}); });
  return NearestCell(object, std::move(inside), runs, threads);
}

std::vector<Box3> NearestCell::boxes_of(const std::vector<Run>& runs) {
  std::vector<Box3> boxes;
  boxes.reserve(runs.size());
  for (const Run& run : runs) boxes.push_back(box_of(run));
  return boxes;
}

NearestCell::NearestCell(const CellObject& object, InsidePieces inside,
                         const std::vector<std::vector<Run>>& runs, unsigned threads)
    : resolution_(object.tile.resolution),
      tiles_(object.grid.tiles),
      corner_(to_vec3(object.grid.box_min)),
      voxel_edge_(object.grid.voxel_edge),
      inside_(std::move(inside)),
      shapes_(runs.size()) {
  find_blocks();
  parallel_for(runs.size(), threads, [&](std::size_t k, unsigned) {
    Shape& shape = shapes_[k];
    shape.tree = BoxTree(boxes_of(runs[k]), 1);
    for (const std::uint32_t r : shape.tree.order()) shape.runs.push_back(runs[k][r]);
  });
  std::vector<Box3> boxes;
  for (const Shape& shape : shapes_) boxes.push_back(shape.tree.box());
  pieces_ = BoxTree(boxes, threads);
}

void NearestCell::find_blocks() {
  const std::uint32_t longest = std::max({tiles_[0], tiles_[1], tiles_[2]});
  // Marks block `b` of level `level`, 0 being tiles, in the block around it.
  const auto mark = [&](std::size_t level, const Index3& b) {
    const std::size_t at =
        b[0] / 2 + std::size_t{blocks_along(tiles_[0], level + 1)} *
                       (b[1] / 2 + std::size_t{blocks_along(tiles_[1], level + 1)} * (b[2] / 2));
    blocks_[level][at] |= std::uint8_t(1u << (b[0] % 2 + 2 * (b[1] % 2) + 4 * (b[2] % 2)));
  };
  for (std::size_t level = 0; level == 0 || blocks_along(longest, level) > 1; ++level) {
    Index3 size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = blocks_along(tiles_[a], level);
    blocks_.emplace_back(std::size_t{blocks_along(tiles_[0], level + 1)} *
                         blocks_along(tiles_[1], level + 1) * blocks_along(tiles_[2], level + 1));
    std::size_t i = 0;
    for (std::uint32_t z = 0; z < size[2]; ++z)
      for (std::uint32_t y = 0; y < size[1]; ++y)
        for (std::uint32_t x = 0; x < size[0]; ++x, ++i)
          if (level == 0 ? inside_.entry(i) != InsidePieces::kNone : blocks_[level - 1][i] != 0)
            mark(level, {x, y, z});
  }
}

double NearestCell::visit_tile(const Index3& tile, Vec3 q, double limit) const {
  const std::uint32_t entry =
      inside_.entry(tile[0] + std::uint64_t{tiles_[0]} * (tile[1] + std::uint64_t{tiles_[1]} * tile[2]));
  for (std::size_t a = 0; a < 3; ++a) q[a] -= double(tile[a]) * resolution_[a];
  return pieces_.visit_near(q, limit, [&](std::uint32_t piece, double so_far) {
    const std::uint32_t k = pieces_.order()[piece];
    if (!inside_.has(entry, k + 1)) return so_far;
    const Shape& shape = shapes_[k];
    return shape.tree.visit_near(q, so_far, [&](std::uint32_t run, double least) {
      return std::min(least, squared_distance(box_of(shape.runs[run]), q));
    });
  });
}

double NearestCell::distance(Vec3 point) const {
  struct Block {
    double distance = 0;
    std::size_t level = 0;  ///< the block has 2^level tiles a side
    Index3 at{};
  };
  const Vec3 q = (point - corner_) / voxel_edge_;
  // Seven of eight halves wait at each of up to 32 levels.
  std::array<Block, 7 * 32 + 1> stack;
  std::size_t size = 0;
  stack[size++] = {0, blocks_.size(), {}};
  double limit = std::numeric_limits<double>::infinity();
  while (size > 0) {
    const Block block = stack[--size];
    if (block.distance > limit) continue;
    if (block.level == 0) {
      limit = visit_tile(block.at, q, limit);
      continue;
    }
    const std::size_t level = block.level - 1, first = size;
    const std::uint8_t halves =
        blocks_[level][block.at[0] +
                       std::size_t{blocks_along(tiles_[0], block.level)} *
                           (block.at[1] + std::size_t{blocks_along(tiles_[1], block.level)} * block.at[2])];
    for (std::uint32_t half = 0; half < 8; ++half) {
      if (!(halves >> half & 1)) continue;
      Block b{0, level, {}};
      Box3 box;
      for (std::size_t a = 0; a < 3; ++a) {
        b.at[a] = 2 * block.at[a] + (half >> a & 1);
        box.min[a] = double(std::uint64_t{b.at[a]} << level) * resolution_[a];
        box.max[a] = double((std::uint64_t{b.at[a]} + 1) << level) * resolution_[a];
      }
      b.distance = squared_distance(box, q);
      if (b.distance > limit) continue;
      // The nearest last, as it is taken first.
      std::size_t place = size++;
      for (; place > first && stack[place - 1].distance < b.distance; --place)
        stack[place] = stack[place - 1];
      stack[place] = b;
    }
  }
  return std::sqrt(limit) * voxel_edge_;
}

}  // namespace mesocell
