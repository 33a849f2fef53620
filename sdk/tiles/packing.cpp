#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/packing.h"

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
  std::vector<Sphere> grow() const {
    std::vector<double> radii(centres_.size(), radius_);
    std::vector<Sphere> spheres;
    const double own = *std::min_element(size_.begin(), size_.end()) / 2;
    for (std::uint32_t i = 0; i < centres_.size(); ++i) {
      double r = std::min(kGrowthLimit * radius_, own);
      // A neighbour that stops the growth is nearer than the sum of both greatest radii, two diameters.
      visit(centres_[i], 2, [&](std::uint32_t j, double distance) {
        if (j != i) r = std::min(r, distance - radii[j]);
      });
      radii[i] = std::max(r, radius_);
      spheres.push_back({centres_[i], radii[i]});
    }
    return spheres;
  }

  [[nodiscard]] std::size_t size() const { return centres_.size(); }

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

}  // namespace

std::vector<Sphere> pack_spheres(const GeneratorOptions& options) {
  const auto& n = options.resolution;
  const double unit = kTileUnit, volume = double(n[0]) * n[1] * n[2] * unit * unit * unit;
  double radius = std::cbrt(volume * kStartFill / options.cells * 3 / (4 * std::numbers::pi));
  // A sphere must not reach its own image through the shortest side.
  radius = std::min(radius, double(std::min({n[0], n[1], n[2]})) * unit / 2);
  Rng rng(options.seed);
  // With smaller spheres if the tile jams, which odd proportions can cause.
  for (;; radius *= 0.9) {
    Packing packing(n, radius);
    for (std::uint64_t tries = 0; tries < 200ull * options.cells + 1000; ++tries) {
      TilePoint p{};
      for (std::size_t a = 0; a < 3; ++a)
        p[a] = std::int32_t(rng.bits(32) * n[a] * std::uint64_t{kTileUnit} >> 32);
      packing.add(p);
      if (packing.size() == options.cells) return packing.grow();
    }
  }
}

}  // namespace mesocell
