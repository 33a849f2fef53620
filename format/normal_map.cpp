#include "format/normal_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace mesocell {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Finds the voxels whose 26 neighbours are all of their instance (empty space counting as one), slice by
/// slice. To be of one instance is an equivalence, so it is enough to chain neighbours axis by axis: rows of
/// three, then squares of nine, then cubes of 27.
template <std::size_t kIdBytes>
class BoundaryFinder {
 public:
  explicit BoundaryFinder(const TileMap& tile)
      : tile_(tile), nx_(tile.resolution[0]), ny_(tile.resolution[1]), nz_(tile.resolution[2]) {}

  /// Counts boundary voxels, and marks them in `boundary` unless that is null.
  std::uint64_t run(std::uint8_t* boundary) {
    const std::size_t slice = nx_ * ny_;
    std::uint64_t count = 0;
    rows_.resize(slice);
    // Squares of slices z − 1, z, z + 1 and of slice 0, and whether voxels equal the one below and above.
    Bytes first(slice), below(slice), above(slice), same_below(slice), same_above(slice);
    squares(nz_ - 1, below);
    squares(0, first);
    Bytes here = first;
    same_as_above(nz_ - 1, same_below);
    for (std::size_t z = 0; z < nz_; ++z) {
      if (z + 1 < nz_) {
        squares(z + 1, above);
      } else {
        above = first;
      }
      same_as_above(z, same_above);
      for (std::size_t i = 0; i < slice; ++i) {
        const auto inner =
            static_cast<std::uint8_t>(below[i] & here[i] & above[i] & same_below[i] & same_above[i]);
        const auto at_boundary = static_cast<std::uint8_t>((inner ^ 1) & (id(z * slice + i) != 0));
        if (boundary) boundary[z * slice + i] = at_boundary;
        count += at_boundary;
      }
      std::swap(below, here);
      std::swap(here, above);
      std::swap(same_below, same_above);
    }
    return count;
  }

 private:
  [[nodiscard]] std::uint32_t id(std::size_t voxel) const {
    const std::uint8_t* p = tile_.voxel_ids.data() + voxel * kIdBytes;
    std::uint32_t v = p[0];
    if constexpr (kIdBytes >= 2) v |= std::uint32_t{p[1]} << 8;
    if constexpr (kIdBytes == 4) v |= std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
    return v;
  }

  /// Whether the piece `a` at the tile's upper face of an axis and the piece `b` at the lower face of the
  /// next tile are of one instance: b's home counts from a tile that is one further.
  [[nodiscard]] std::uint8_t same_across(std::uint32_t a, std::uint32_t b, std::size_t axis) const {
    if (a == 0 || b == 0) return a == b;
    const Piece& p = tile_.pieces[a - 1];
    const Piece& q = tile_.pieces[b - 1];
    if (p.cell != q.cell) return 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (p.home[k] != q.home[k] + (k == axis ? 1 : 0)) return 0;
    return 1;
  }

  /// 1 where a voxel and its neighbours in x and y, diagonals too, are of one instance.
  void squares(std::size_t z, Bytes& out) {
    const std::size_t base = z * nx_ * ny_;
    for (std::size_t y = 0; y < ny_; ++y) {
      const std::size_t row = base + y * nx_;
      std::uint8_t* three = rows_.data() + y * nx_;
      for (std::size_t x = 1; x + 1 < nx_; ++x)
        three[x] = static_cast<std::uint8_t>(int{id(row + x - 1) == id(row + x)} &
                                             int{id(row + x) == id(row + x + 1)});
      const std::uint8_t wrap = same_across(id(row + nx_ - 1), id(row), 0);
      three[0] = wrap & static_cast<std::uint8_t>(id(row) == id(row + 1));
      three[nx_ - 1] = wrap & static_cast<std::uint8_t>(id(row + nx_ - 2) == id(row + nx_ - 1));
    }
    for (std::size_t y = 0; y < ny_; ++y) {
      const std::size_t up = y + 1 < ny_ ? y + 1 : 0, down = y > 0 ? y - 1 : ny_ - 1;
      const std::uint8_t *a = &rows_[down * nx_], *b = &rows_[y * nx_], *c = &rows_[up * nx_];
      const std::size_t row_a = base + down * nx_, row_b = base + y * nx_, row_c = base + up * nx_;
      for (std::size_t x = 0; x < nx_; ++x) {
        out[y * nx_ + x] = static_cast<std::uint8_t>(a[x] & b[x] & c[x] & (id(row_a + x) == id(row_b + x)) &
                                                     (id(row_b + x) == id(row_c + x)));
      }
      // Where the column wraps, ids do not tell: homes are counted from different tiles.
      if (y != 0 && y + 1 != ny_) continue;
      for (std::size_t x = 0; x < nx_; ++x) {
        const std::uint8_t same_down =
            y > 0 ? id(row_a + x) == id(row_b + x) : same_across(id(row_a + x), id(row_b + x), 1);
        const std::uint8_t same_up =
            y + 1 < ny_ ? id(row_b + x) == id(row_c + x) : same_across(id(row_b + x), id(row_c + x), 1);
        out[y * nx_ + x] = static_cast<std::uint8_t>(a[x] & b[x] & c[x] & same_down & same_up);
      }
    }
  }

  /// 1 where a voxel of slice z and the one above are of one instance.
  void same_as_above(std::size_t z, Bytes& out) const {
    const std::size_t slice = nx_ * ny_, from = z * slice;
    if (z + 1 < nz_) {
      for (std::size_t i = 0; i < slice; ++i) out[i] = id(from + i) == id(from + slice + i);
    } else {
      for (std::size_t i = 0; i < slice; ++i) out[i] = same_across(id(from + i), id(i), 2);
    }
  }

  const TileMap& tile_;
  std::size_t nx_, ny_, nz_;
  Bytes rows_;
};

std::uint64_t find_boundary(const TileMap& tile, std::uint8_t* boundary) {
  switch (tile.id_bytes) {
    case 1:
      return BoundaryFinder<1>(tile).run(boundary);
    case 2:
      return BoundaryFinder<2>(tile).run(boundary);
    default:
      return BoundaryFinder<4>(tile).run(boundary);
  }
}

// ---- Octahedral codes

/// Codes from the centre of the square to its edge. A number that 2 and 3 divide makes axes and the diagonals
/// between two or three of them exact.
constexpr int kSteps = kMaxNormalByte / 2;
static_assert(kSteps % 6 == 0);

/// The direction of place (u, v) of the square, −126…126 each, with integer components.
std::array<int, 3> direction(int u, int v) {
  const int z = kSteps - std::abs(u) - std::abs(v);
  if (z >= 0) return {u, v, z};
  const int x = kSteps - std::abs(v), y = kSteps - std::abs(u);
  return {u < 0 ? -x : x, v < 0 ? -y : y, z};
}

}  // namespace

std::vector<std::uint8_t> boundary_voxels(const TileMap& tile) {
  std::vector<std::uint8_t> boundary(static_cast<std::size_t>(tile.voxel_count()));
  (void)find_boundary(tile, boundary.data());
  return boundary;
}

std::uint64_t count_boundary_voxels(const TileMap& tile) { return find_boundary(tile, nullptr); }

std::array<std::uint8_t, 2> encode_normal(std::array<double, 3> unit) {
  // 2^16 steps a unit keep every product below within 64 bits; scaling by a power of two is exact.
  constexpr double kScale = 65536;
  std::array<std::int64_t, 3> n{};
  bool finite = true;
  for (std::size_t a = 0; a < 3; ++a) finite = finite && std::isfinite(unit[a]);
  for (std::size_t a = 0; finite && a < 3; ++a) n[a] = std::llround(std::clamp(unit[a], -1.0, 1.0) * kScale);
  const std::int64_t ax = std::abs(n[0]), ay = std::abs(n[1]), sum = ax + ay + std::abs(n[2]);
  if (sum == 0) return {kSteps, kSteps};

  // The place in the square's first quarter lies between four codes; the one of least angle is taken.
  const std::int64_t u = kSteps * (n[2] < 0 ? sum - ay : ax) / sum;
  const std::int64_t v = kSteps * (n[2] < 0 ? sum - ax : ay) / sum;
  std::array<int, 2> best{};
  std::int64_t best_dot = 0, best_length = 1;  // squares of the dot product and of the direction's length
  for (int k = 0; k < 4; ++k) {
    const int cu = static_cast<int>(std::min<std::int64_t>(u + (k & 1), kSteps)) * (n[0] < 0 ? -1 : 1);
    const int cv = static_cast<int>(std::min<std::int64_t>(v + (k >> 1), kSteps)) * (n[1] < 0 ? -1 : 1);
    const auto d = direction(cu, cv);
    const std::int64_t dot = std::max<std::int64_t>(0, n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
    const std::int64_t length =
        std::int64_t{d[0]} * d[0] + std::int64_t{d[1]} * d[1] + std::int64_t{d[2]} * d[2];
    if (dot * dot * best_length > best_dot * length) {
      best = {cu, cv};
      best_dot = dot * dot;
      best_length = length;
    }
  }
  return {static_cast<std::uint8_t>(best[0] + kSteps), static_cast<std::uint8_t>(best[1] + kSteps)};
}

std::array<double, 3> decode_normal(std::array<std::uint8_t, 2> code) {
  const auto d =
      direction(std::min<int>(code[0], 2 * kSteps) - kSteps, std::min<int>(code[1], 2 * kSteps) - kSteps);
  // The squared length is an exact integer, so each component is rounded the same way everywhere.
  const double length = std::sqrt(static_cast<double>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
  return {d[0] / length, d[1] / length, d[2] / length};
}

}  // namespace mesocell
