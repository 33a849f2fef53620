#include "sdk/trace/tile_blocks.h"

#include <algorithm>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kMaxEdge = 127;
/// Blocks of a tile whose bricks take no more than 1 MB in all octants.
constexpr std::uint64_t kFlatBlocks = 512;

/// Whether piece `p`, and piece `q` of the tile that is `step` tiles on, are of one instance; 0 is empty
/// space.
bool same_instance(const TileMap& tile, std::uint32_t p, std::uint32_t q,
                   const std::array<std::int32_t, 3>& step) {
  if (step == std::array<std::int32_t, 3>{}) return p == q;
  if (p == 0 || q == 0) return p == q;
  const Piece &a = tile.pieces[p - 1], &b = tile.pieces[q - 1];
  return a.cell == b.cell && a.home[0] == b.home[0] + step[0] && a.home[1] == b.home[1] + step[1] &&
         a.home[2] == b.home[2] + step[2];
}

}  // namespace

/// For each voxel how many in a row, at most `most`, are of its instance, itself included, in both directions
/// of each axis and across the tile's end.
struct TileBlocks::Runs {
  std::vector<std::uint32_t> ids;
  std::array<std::array<std::vector<std::uint8_t>, 2>, 3> run;  ///< [axis][up]

  Runs(const TileMap& tile, std::uint32_t most) : ids(tile.voxel_count()) {
    for (std::uint64_t i = 0; i < ids.size(); ++i) ids[i] = tile.id(i);
    parallel_for(6, 0, [&](std::size_t k, unsigned) { find(tile, k / 2, k % 2 != 0, most); });
  }

 private:
  void find(const TileMap& tile, std::size_t axis, bool up, std::uint32_t most) {
    std::vector<std::uint8_t>& out = run[axis][up];
    out.resize(ids.size());
    const std::array<std::uint64_t, 3> stride{1, tile.resolution[0],
                                              std::uint64_t{tile.resolution[0]} * tile.resolution[1]};
    const std::uint32_t n = tile.resolution[axis];
    std::array<std::int32_t, 3> step{};
    step[axis] = up ? 1 : -1;
    const auto place = [&](std::uint32_t k) { return (up ? n - 1 - k : k) * stride[axis]; };
    const std::size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    for (std::uint32_t j = 0; j < tile.resolution[v]; ++j)
      for (std::uint32_t i = 0; i < tile.resolution[u]; ++i) {
        const std::uint64_t row = i * stride[u] + j * stride[v];
        // What comes after the tile's end first: the voxels at its other end.
        std::uint32_t count = 1;
        while (count < std::min(most, n) && ids[row + place(n - count)] == ids[row + place(n - count - 1)])
          ++count;
        bool same = same_instance(tile, ids[row + place(0)], ids[row + place(n - 1)], step);
        for (std::uint32_t k = 0; k < n; ++k) {
          const std::uint64_t at = row + place(k);
          if (k > 0) same = ids[at] == ids[row + place(k - 1)];
          count = same ? std::min(count + 1, most) : 1;
          out[at] = std::uint8_t(count);
        }
      }
  }
};

TileBlocks::TileBlocks(const TileMap& tile) {
  block_count_ = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    resolution_[a] = tile.resolution[a];
    part_shift_[a] = 2;
    while (4u << part_shift_[a] < resolution_[a]) ++part_shift_[a];
    const std::uint32_t part = 1u << part_shift_[a];
    pad_[a] = (resolution_[a] + part - 1) / part * part - resolution_[a];
    blocks_[a] = (resolution_[a] + pad_[a]) / 4;
    end_[a] = resolution_[a] % 4 == 0 ? 1u << 30 : resolution_[a];
    block_count_ *= blocks_[a];
  }
  flat_ = block_count_ <= kFlatBlocks;
  // Two bytes a voxel where they hold the ids, else four.
  for (const std::array<unsigned, 3>& layout : {std::array<unsigned, 3>{7, 3, 1}, {20, 4, 2}, {26, 2, 2}})
    if (id_bits_ = layout[0], edge_bits_ = layout[1], voxel_shift_ = layout[2];
        tile.pieces.size() >> id_bits_ == 0)
      break;
  find_blocks(tile);
  brick_count_ = flat_ ? std::uint32_t(block_count_) : std::uint32_t(mixed_.size());
  bricks_.resize((std::size_t{brick_count_} * 64 * 8 << voxel_shift_) + 4);  // four are read at a time
  if (!flat_) records_.resize(8 * block_count_);
  const Runs runs(tile, 1u << edge_bits_);
  parallel_for(8, 0, [&](std::size_t octant, unsigned) {
    make_bricks(runs, unsigned(octant));
    if (!flat_) make_records(tile, unsigned(octant));
  });
  plain_ = {};
  mixed_ = {};
}

void TileBlocks::find_blocks(const TileMap& tile) {
  plain_.assign(block_count_, 0);
  parts_of_.assign(tile.pieces.size() + 1, 0);
  std::array<std::uint32_t, 3> b{};
  for (b[2] = 0; b[2] < (resolution_[2] + 3) / 4; ++b[2])
    for (b[1] = 0; b[1] < (resolution_[1] + 3) / 4; ++b[1])
      for (b[0] = 0; b[0] < (resolution_[0] + 3) / 4; ++b[0]) {
        const std::array<std::uint32_t, 3> first{4 * b[0], 4 * b[1], 4 * b[2]};
        const std::uint64_t index = block_of(first);
        const Bits64 part = Bits64{1} << ((first[0] >> part_shift_[0]) + 4 * (first[1] >> part_shift_[1]) +
                                          16 * (first[2] >> part_shift_[2]));
        std::uint32_t id = tile.id(tile.voxel_index(first[0], first[1], first[2]));
        const std::uint32_t id0 = id;
        bool one = true;
        for (std::uint32_t z = first[2]; z < std::min(first[2] + 4, resolution_[2]); ++z)
          for (std::uint32_t y = first[1]; y < std::min(first[1] + 4, resolution_[1]); ++y)
            for (std::uint32_t x = first[0]; x < std::min(first[0] + 4, resolution_[0]); ++x) {
              id = tile.id(tile.voxel_index(x, y, z));
              one = one && id == id0;
              parts_of_[id] |= part;
            }
        plain_[index] = id0;
        if (one && !flat_) continue;
        plain_[index] = kMixed + std::uint32_t(mixed_.size());
        mixed_.push_back(first);
      }
}

void TileBlocks::make_bricks(const Runs& runs, unsigned octant) {
  const std::uint32_t most = 1u << edge_bits_;
  const std::array<const std::uint8_t*, 3> run{runs.run[0][octant & 1].data(),
                                               runs.run[1][octant >> 1 & 1].data(),
                                               runs.run[2][octant >> 2 & 1].data()};
  // Places that are up to `most` voxels on, around the torus.
  std::array<std::vector<std::uint32_t>, 3> on;
  std::uint32_t stride = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t n = resolution_[a];
    for (std::uint32_t k = 0; k < n + most; ++k)
      on[a].push_back((octant >> a & 1 ? k % n : n - 1 - k % n) * stride);
    stride *= n;
  }
  std::uint8_t* const bricks = bricks_.data() + (std::size_t{octant} * brick_count_ * 64 << voxel_shift_);
  for (const std::array<std::uint32_t, 3>& first : mixed_) {
    std::array<std::uint32_t, 3> block{};  // mirrored
    for (std::size_t a = 0; a < 3; ++a)
      block[a] = octant >> a & 1 ? first[a] / 4 : blocks_[a] - 1 - first[a] / 4;
    const std::uint64_t number =
        flat_ ? block[0] + std::uint64_t{blocks_[0]} * (block[1] + std::uint64_t{blocks_[1]} * block[2])
              : plain_[block_of(first)] - kMixed;
    for (std::uint32_t k = 0; k < 64; ++k) {
      const std::array<std::uint32_t, 3> in{k & 3, k >> 2 & 3, k >> 4};
      std::array<const std::uint32_t*, 3> to{};  // places from the voxel on
      bool there = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const std::uint32_t place = 4 * block[a] + in[a], pad = octant >> a & 1 ? 0 : pad_[a];
        there = there && place >= pad && place - pad < resolution_[a];
        if (there) to[a] = on[a].data() + (place - pad);
      }
      if (!there) continue;
      // A cube first. Runs that begin at a voxel of the instance stay in it, so runs from runs from a run
      // span it.
      std::uint32_t e = 1, along_x = run[0][to[0][0] + to[1][0] + to[2][0]],
                    along_z = run[2][to[0][0] + to[1][0] + to[2][0]];
      const std::uint32_t along_y = run[1][to[0][0] + to[1][0] + to[2][0]];
      for (; e < most && along_y > e; ++e) {
        along_z = std::min<std::uint32_t>(along_z, run[2][to[0][0] + to[1][e] + to[2][0]]);
        if (along_z <= e) break;
        for (std::uint32_t i = 0; i <= e && along_x > e; ++i)
          along_x = std::min({along_x, std::uint32_t{run[0][to[0][0] + to[1][e] + to[2][i]]},
                              std::uint32_t{run[0][to[0][0] + to[1][i] + to[2][e]]}});
        if (along_x <= e) break;
      }
      std::array<std::uint32_t, 3> edge{e, e, e};
      const auto least_run = [&](std::size_t a) {  // along axis a, over the rectangle of the other two
        const std::size_t u = a == 0 ? 1 : 0, v = a == 2 ? 1 : 2;
        std::uint32_t least = most;
        for (std::uint32_t j = 0; j < edge[v] && least > e; ++j)
          for (std::uint32_t i = 0; i < edge[u] && least > e; ++i)
            least = std::min<std::uint32_t>(least, run[a][to[a][0] + to[u][i] + to[v][j]]);
        return least;
      };
      // Then longer on one axis after the other, that one first on which the voxel's own run is longest.
      std::array<std::size_t, 3> order{0, 1, 2};
      const std::size_t at = to[0][0] + to[1][0] + to[2][0];
      const std::array<std::uint8_t, 3> can{run[0][at], run[1][at], run[2][at]};
      if (can[order[1]] > can[order[0]]) std::swap(order[0], order[1]);
      if (can[order[2]] > can[order[1]]) std::swap(order[1], order[2]);
      if (can[order[1]] > can[order[0]]) std::swap(order[0], order[1]);
      for (const std::size_t a : order) edge[a] = least_run(a);
      std::uint32_t voxel = runs.ids[at];
      for (std::size_t a = 0; a < 3; ++a) voxel |= (edge[a] - 1) << (id_bits_ + a * edge_bits_);
      const std::uint16_t half = std::uint16_t(voxel);
      if (voxel_shift_ == 1)
        std::memcpy(bricks + 2 * (64 * number + k), &half, sizeof half);
      else
        std::memcpy(bricks + 4 * (64 * number + k), &voxel, sizeof voxel);
    }
  }
}

void TileBlocks::make_records(const TileMap& tile, unsigned octant) {
  std::uint32_t* const records = records_.data() + octant * block_count_;
  std::copy(plain_.begin(), plain_.end(), records);
  // Blocks that have voxels, along each axis: those of the padding are not visited.
  const std::array<std::int64_t, 3> n{(resolution_[0] + 3) / 4, (resolution_[1] + 3) / 4,
                                      (resolution_[2] + 3) / 4};
  const auto at = [&](const std::array<std::int64_t, 3>& b) {
    return std::uint64_t(b[0] + blocks_[0] * (b[1] + std::int64_t{blocks_[1]} * b[2]));
  };
  std::vector<std::uint8_t> edge(block_count_, 0);
  for (std::uint64_t i = 0; i < block_count_; ++i) edge[i] = records[i] & kMixed ? 0 : kMaxEdge;
  // The greatest edges that agree with their neighbours', from above: around the torus it may take some
  // sweeps.
  for (bool changed = true; changed;) {
    changed = false;
    std::array<std::int64_t, 3> k{}, b{};
    for (k[2] = 0; k[2] < n[2]; ++k[2])
      for (k[1] = 0; k[1] < n[1]; ++k[1])
        for (k[0] = 0; k[0] < n[0]; ++k[0]) {
          for (std::size_t a = 0; a < 3; ++a) b[a] = octant >> a & 1 ? n[a] - 1 - k[a] : k[a];
          const std::uint64_t i = at(b);
          if (edge[i] <= 1) continue;
          std::uint32_t least = kMaxEdge - 1;
          for (unsigned c = 1; c < 8 && least > 0; ++c) {
            std::array<std::int64_t, 3> to = b;
            std::array<std::int32_t, 3> step{};
            bool clipped = false;
            for (std::size_t a = 0; a < 3; ++a) {
              if (!(c >> a & 1)) continue;
              to[a] += octant >> a & 1 ? 1 : -1;
              if (to[a] >= 0 && to[a] < n[a]) continue;
              // A tile that does not end with a block ends its boxes.
              clipped = clipped || resolution_[a] % 4 != 0;
              step[a] = to[a] < 0 ? -1 : 1;
              to[a] = to[a] < 0 ? n[a] - 1 : 0;
            }
            if (clipped) continue;
            const std::uint64_t j = at(to);
            const bool same = edge[j] > 0 && same_instance(tile, records[i], records[j], step);
            least = std::min<std::uint32_t>(least, same ? edge[j] : 0);
          }
          if (least + 1 >= edge[i]) continue;
          edge[i] = std::uint8_t(least + 1);
          changed = true;
        }
  }
  for (std::uint64_t i = 0; i < block_count_; ++i)
    if (!(records[i] & kMixed)) records[i] |= std::uint32_t{edge[i]} << kEdgeShift;
  // Into the order of the mirrored tile.
  std::vector<std::uint32_t> order(records, records + block_count_);
  std::array<std::uint32_t, 3> b{};
  std::uint64_t i = 0;
  for (b[2] = 0; b[2] < blocks_[2]; ++b[2])
    for (b[1] = 0; b[1] < blocks_[1]; ++b[1])
      for (b[0] = 0; b[0] < blocks_[0]; ++b[0], ++i) {
        std::array<std::uint32_t, 3> m{};
        for (std::size_t a = 0; a < 3; ++a) m[a] = octant >> a & 1 ? b[a] : blocks_[a] - 1 - b[a];
        records[m[0] + std::uint64_t{blocks_[0]} * (m[1] + std::uint64_t{blocks_[1]} * m[2])] = order[i];
      }
}

Bits64 TileBlocks::mirrored_parts(Bits64 parts, unsigned octant) const {
  Bits64 m = mirrored(parts, octant);
  // A tile of three parts has its last one first, after one that it does not have.
  unsigned shift = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (!(octant >> a & 1)) shift += (4 - ((resolution_[a] + pad_[a]) >> part_shift_[a])) << (2 * a);
  return m >> shift;
}

}  // namespace mesocell
