#include "sdk/trace/reach.h"

#include <algorithm>
#include <array>
#include <map>

#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

constexpr std::uint8_t kFar = 255;

std::uint8_t farther(std::uint8_t d) { return d == kFar ? kFar : std::uint8_t(d + 1); }

/// One sweep of a two-pass distance transform: every row takes what its four predecessors and its own voxels
/// offer. Returns whether anything changed.
class Sweep {
 public:
  Sweep(std::vector<std::uint8_t>& distance, const Index3& size, Border border)
      : distance_(distance), n_{size[0], size[1], size[2]}, wrap_(border == Border::kWrapped) {
    best_.resize(size[0]);
    spread_.resize(size[0]);
  }

  bool run(std::int64_t direction) {
    bool changed = false;
    for (std::int64_t k = 0; k < n_[2]; ++k)
      for (std::int64_t j = 0; j < n_[1]; ++j) {
        const std::int64_t z = direction > 0 ? k : n_[2] - 1 - k, y = direction > 0 ? j : n_[1] - 1 - j;
        changed |= sweep_row(y, z, direction);
      }
    return changed;
  }

 private:
  [[nodiscard]] std::uint8_t* row(std::int64_t y, std::int64_t z) {
    if (wrap_) {
      y = (y + n_[1]) % n_[1];
      z = (z + n_[2]) % n_[2];
    } else if (y < 0 || z < 0 || y >= n_[1] || z >= n_[2]) {
      return nullptr;
    }
    return distance_.data() + n_[0] * (y + n_[1] * z);
  }

  bool sweep_row(std::int64_t y, std::int64_t z, std::int64_t back) {
    const std::size_t width = std::size_t(n_[0]);
    std::fill(best_.begin(), best_.end(), kFar);
    const std::uint8_t* const before[] = {row(y - back, z), row(y - 1, z - back), row(y, z - back),
                                          row(y + 1, z - back)};
    for (const std::uint8_t* r : before)
      if (r)
        for (std::size_t x = 0; x < width; ++x) best_[x] = std::min(best_[x], r[x]);
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint8_t left = x > 0 ? best_[x - 1] : wrap_ ? best_[width - 1] : kFar;
      const std::uint8_t right = x + 1 < width ? best_[x + 1] : wrap_ ? best_[0] : kFar;
      spread_[x] = farther(std::min({left, best_[x], right}));
    }
    std::uint8_t* const d = row(y, z);
    bool changed = false;
    const auto lower = [&](std::size_t x, std::uint8_t value) {
      changed |= value < d[x];
      d[x] = std::min(d[x], value);
    };
    for (std::size_t x = 0; x < width; ++x) lower(x, spread_[x]);
    if (wrap_) lower(0, farther(d[width - 1]));
    for (std::size_t x = 1; x < width; ++x) lower(x, farther(d[x - 1]));
    if (wrap_) lower(width - 1, farther(d[0]));
    for (std::size_t x = width - 1; x-- > 0;) lower(x, farther(d[x + 1]));
    return changed;
  }

  std::vector<std::uint8_t>& distance_;
  std::array<std::int64_t, 3> n_;
  bool wrap_;
  std::vector<std::uint8_t> best_, spread_;
};

/// Tells whether a piece and one in the next tile along an axis are of the same instance.
class Continuation {
 public:
  explicit Continuation(const TileMap& tile) {
    using Key = std::array<int, 4>;
    std::map<Key, std::uint32_t> id_of;
    for (std::size_t k = 0; k < tile.pieces.size(); ++k) {
      const Piece& p = tile.pieces[k];
      id_of[{p.cell, p.home[0], p.home[1], p.home[2]}] = std::uint32_t(k + 1);
    }
    for (std::size_t a = 0; a < 3; ++a)
      for (int side = 0; side < 2; ++side) {
        seen_as_[a][side].push_back(0);
        for (const Piece& p : tile.pieces) {
          Key key{p.cell, p.home[0], p.home[1], p.home[2]};
          key[a + 1] += side == 1 ? 1 : -1;
          const auto found = id_of.find(key);
          seen_as_[a][side].push_back(found == id_of.end() ? kNone : found->second);
        }
      }
  }

  /// The id by which a piece of the next tile (side 1) or the one before (side 0) is known in this one, kNone
  /// if its instance has no voxel here.
  [[nodiscard]] std::uint32_t seen_as(std::size_t axis, int side, std::uint32_t id) const {
    return seen_as_[axis][side][id];
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::array<std::array<std::vector<std::uint32_t>, 2>, 3> seen_as_;
};

}  // namespace

void chebyshev_transform(std::vector<std::uint8_t>& distance, const Index3& size, Border border) {
  Sweep sweep(distance, size, border);
  // Two sweeps do on an open grid; around the torus a distance may have to travel on.
  for (bool changed = true; changed;) {
    changed = sweep.run(1);
    changed |= sweep.run(-1);
    if (border == Border::kOpen) break;
  }
}

std::vector<std::uint8_t> instance_reach(const TileMap& tile) {
  const Continuation continuation(tile);
  const std::array<std::uint64_t, 3> n{tile.resolution[0], tile.resolution[1], tile.resolution[2]};
  const std::array<std::uint64_t, 3> stride{1, n[0], n[0] * n[1]};
  // A 3×3×3 block is of one instance if its rows are, its slices of rows are, and its stack of slices is.
  std::vector<std::uint8_t> uniform(tile.voxel_count(), 1), next(uniform.size());
  for (std::size_t a = 0; a < 3; ++a) {
    parallel_for(n[2], 0, [&](std::size_t z, unsigned) {
      std::array<std::uint64_t, 3> at{0, 0, z};
      std::uint64_t i = z * stride[2];
      for (at[1] = 0; at[1] < n[1]; ++at[1])
        for (at[0] = 0; at[0] < n[0]; ++at[0], ++i) {
          const bool first = at[a] == 0, last = at[a] + 1 == n[a];
          const std::uint64_t wrap = (n[a] - 1) * stride[a];
          const std::uint64_t up = last ? i - wrap : i + stride[a], down = first ? i + wrap : i - stride[a];
          next[i] = 0;
          if (!(uniform[i] && uniform[up] && uniform[down])) continue;
          const std::uint32_t id = tile.id(i), id_up = tile.id(up), id_down = tile.id(down);
          next[i] = id == (last ? continuation.seen_as(a, 1, id_up) : id_up) &&
                    id == (first ? continuation.seen_as(a, 0, id_down) : id_down);
        }
    });
    uniform.swap(next);
  }
  // Distance 0 where the block around a voxel is not uniform: such a voxel reaches only itself.
  for (std::uint8_t& u : uniform) u = u ? kFar : 0;
  chebyshev_transform(uniform, tile.resolution, Border::kWrapped);
  return uniform;
}

}  // namespace mesocell
