#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/generators.h"

namespace mesocell {
namespace {

/// Share of the tile that the spheres fill before they grow. Random placement jams at 0.38; at a quarter it
/// always ends after few tries.
constexpr double kStartFill = 0.25;
constexpr double kGrowthLimit = 2;

/// Sphere centres on the torus in buckets, to find neighbours in constant time. Lengths in 1/1024 voxel.
class Packing {
 public:
  Packing(const Index3& resolution, double radius) : radius_(radius) {
    for (std::size_t a = 0; a < 3; ++a) {
      size_[a] = double(resolution[a]) * kTileUnit;
      // A bucket is at least a diameter wide, so that whatever touches lies in the next bucket at most.
      buckets_[a] = std::int64_t(std::clamp(std::floor(size_[a] / (2 * radius)), 1.0, 256.0));
    }
    grid_.resize(std::size_t(buckets_[0] * buckets_[1] * buckets_[2]));
  }

  /// Adds a sphere of the starting radius unless it would overlap another or its own image.
  bool add(const TilePoint& p) {
    bool free = true;
    visit(p, 1, [&](std::uint32_t, double distance) { free = free && distance >= 2 * radius_; });
    if (!free) return false;
    grid_[bucket(p)].push_back(std::uint32_t(centres_.size()));
    centres_.push_back(p);
    return true;
  }

  /// Grows the spheres in turn until each touches another or has reached the limit.
  std::vector<double> grow() const {
    std::vector<double> radii(centres_.size(), radius_);
    const double own = *std::min_element(size_.begin(), size_.end()) / 2;
    for (std::uint32_t i = 0; i < centres_.size(); ++i) {
      double r = std::min(kGrowthLimit * radius_, own);
      // A neighbour that stops the growth is nearer than the sum of both greatest radii, two diameters.
      visit(centres_[i], 2, [&](std::uint32_t j, double distance) {
        if (j != i) r = std::min(r, distance - radii[j]);
      });
      radii[i] = std::max(r, radius_);
    }
    return radii;
  }

  [[nodiscard]] const std::vector<TilePoint>& centres() const { return centres_; }

 private:
  [[nodiscard]] std::int64_t axis_bucket(const TilePoint& p, std::size_t a) const {
    return std::int64_t(p[a]) * buckets_[a] / std::int64_t(size_[a]);
  }
  [[nodiscard]] std::size_t bucket(const TilePoint& p) const {
    return std::size_t(axis_bucket(p, 0) +
                       buckets_[0] * (axis_bucket(p, 1) + buckets_[1] * axis_bucket(p, 2)));
  }

  /// Calls f(index, torus distance) for every centre at most `reach` buckets away.
  template <typename F>
  void visit(const TilePoint& p, std::int64_t reach, F f) const {
    std::int64_t low[3], count[3];
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = axis_bucket(p, a) - reach;
      count[a] = std::min(2 * reach + 1, buckets_[a]);  // each bucket once, also where few wrap around
    }
    for (std::int64_t z = 0; z < count[2]; ++z)
      for (std::int64_t y = 0; y < count[1]; ++y)
        for (std::int64_t x = 0; x < count[0]; ++x) {
          const auto wrap = [&](std::int64_t k, std::size_t a) {
            return (low[a] + k + 2 * buckets_[a]) % buckets_[a];
          };
          for (const std::uint32_t j :
               grid_[std::size_t(wrap(x, 0) + buckets_[0] * (wrap(y, 1) + buckets_[1] * wrap(z, 2)))])
            f(j, distance(p, centres_[j]));
        }
  }

  [[nodiscard]] double distance(const TilePoint& p, const TilePoint& q) const {
    double sum = 0;  // of squares of integers below 2^21: exact, so the root is the same everywhere
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = std::abs(double(p[a]) - double(q[a]));
      const double shortest = std::min(d, size_[a] - d);
      sum += shortest * shortest;
    }
    return std::sqrt(sum);
  }

  double radius_;
  std::array<double, 3> size_{};
  std::array<std::int64_t, 3> buckets_{};
  std::vector<std::vector<std::uint32_t>> grid_;
  std::vector<TilePoint> centres_;
};

/// Places all centres, with smaller spheres if the tile jams (which odd proportions can cause).
Packing pack(const GeneratorOptions& options) {
  const auto& n = options.resolution;
  const double unit = kTileUnit, volume = double(n[0]) * n[1] * n[2] * unit * unit * unit;
  double radius = std::cbrt(volume * kStartFill / options.cells * 3 / (4 * std::numbers::pi));
  // A sphere must not reach its own image through the shortest side.
  radius = std::min(radius, double(std::min({n[0], n[1], n[2]})) * unit / 2);
  Rng rng(options.seed);
  for (;; radius *= 0.9) {
    Packing packing(n, radius);
    for (std::uint64_t tries = 0; tries < 200ull * options.cells + 1000; ++tries) {
      TilePoint p{};
      for (std::size_t a = 0; a < 3; ++a)
        p[a] = std::int32_t(rng.bits(32) * n[a] * std::uint64_t{kTileUnit} >> 32);
      packing.add(p);
      if (packing.centres().size() == options.cells) return packing;
    }
  }
}

}  // namespace

Result<TileMap> make_spheres_tile(const GeneratorOptions& options, TileReport* report) {
  const Packing packing = pack(options);
  const std::vector<double> radii = packing.grow();
  TileBuilder builder(options.resolution, options.cells);
  const auto& n = options.resolution;

  // Spheres are disjoint, so each can be filled on its own.
  std::atomic<bool> any{false};
  const bool done = parallel_for(
      radii.size(), options.threads,
      [&](std::size_t k, unsigned) {
        const TilePoint& c = packing.centres()[k];
        const double r2 = radii[k] * radii[k];
        std::array<std::int32_t, 3> low{}, high{};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::int32_t(std::floor((c[a] - radii[k]) / kTileUnit));
          high[a] = std::int32_t(std::ceil((c[a] + radii[k]) / kTileUnit));
        }
        for (std::int32_t z = low[2]; z < high[2]; ++z)
          for (std::int32_t y = low[1]; y < high[1]; ++y)
            for (std::int32_t x = low[0]; x < high[0]; ++x) {
              const std::array<std::int32_t, 3> v{x, y, z};
              double d2 = 0;
              std::array<std::int32_t, 3> shift{}, wrapped{};
              for (std::size_t a = 0; a < 3; ++a) {
                const double d = double(v[a]) * kTileUnit + kTileUnit / 2 - c[a];
                d2 += d * d;
                const std::int32_t size = std::int32_t(n[a]);
                const std::int32_t tile = v[a] < 0 ? -1 : v[a] >= size ? 1 : 0;
                wrapped[a] = v[a] - tile * size;
                shift[a] = -tile;  // seen from the wrapped voxel, the centre is that far away
              }
              if (d2 >= r2) continue;
              const std::uint64_t i = std::uint64_t(wrapped[0]) +
                                      std::uint64_t{n[0]} * (std::uint64_t(wrapped[1]) +
                                                             std::uint64_t{n[1]} * std::uint64_t(wrapped[2]));
              builder.set(i, TileBuilder::code(std::uint32_t(k + 1),
                                               TileBuilder::image_index(shift[0], shift[1], shift[2])));
              any = true;
            }
      },
      options.progress, "tile");
  if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
  if (!any)
    return Error{ErrorCode::kUsage,
                 "no sphere of this tile holds a voxel centre; use fewer cells or a higher resolution"};
  return builder.finish(options.threads, report);
}

}  // namespace mesocell
