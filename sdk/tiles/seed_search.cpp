#include "sdk/tiles/seed_search.h"

#include <algorithm>
#include <cmath>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/random_rotation.h"

namespace mesocell {
namespace {

/// Bounds are rounded; this much more keeps every candidate that rounding might have lost.
constexpr double kSlack = 1e-9;
/// Boxes of so few voxels are not split further.
constexpr std::uint64_t kLeafVoxels = 64;

/// Lengths are stretched by at most this and shrunk by at most its inverse. Then the nearest image of a seed
/// is at most two tiles away: the lattice of its images, so stretched, leaves no point farther than 1.4² √3/2
/// tiles from one.
constexpr double kMaxStretch = 1.4;
/// Greatest weight taken from a distance, in mean distances between seeds.
constexpr double kMaxSubtracted = 0.5;
/// Weights that distances are divided by are in [1, this].
constexpr double kMaxDivisor = 2;

double centre(std::uint32_t voxel) { return double(voxel) * kTileUnit + kTileUnit / 2; }

}  // namespace

double mean_spacing(const GeneratorOptions& options) {
  const Index3& n = options.resolution;
  return std::cbrt(double(n[0]) * n[1] * n[2] / options.cells) * kTileUnit;
}

std::vector<TilePoint> random_tile_points(const GeneratorOptions& options, std::uint32_t count) {
  Rng rng(options.seed);
  std::vector<TilePoint> points(count);
  for (TilePoint& p : points)
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = std::int32_t(rng.bits(32) * options.resolution[a] * std::uint64_t{kTileUnit} >> 32);
  return points;
}

std::vector<Seed> random_seeds(const GeneratorOptions& options, SeedMetric metric) {
  // Places and weights are drawn apart, so that a seed number gives the same places in every metric.
  Rng rng(~options.seed);
  std::vector<Seed> seeds;
  for (const TilePoint& p : random_tile_points(options, options.cells)) {
    Seed seed;
    seed.at = p;
    if (metric == SeedMetric::kAdditive) seed.weight = rng.uniform(0, kMaxSubtracted) * mean_spacing(options);
    if (metric == SeedMetric::kMultiplicative) seed.weight = rng.uniform(1, kMaxDivisor);
    if (metric == SeedMetric::kAnisotropic) {
      const Rotation rotation = random_rotation(rng);
      seed.least = kMaxStretch;
      seed.most = 1 / kMaxStretch;
      for (std::size_t r = 0; r < 3; ++r) {
        const double u = rng.uniform(1, kMaxStretch), s = rng.below(2) ? u : 1 / u;
        for (std::size_t c = 0; c < 3; ++c) seed.stretch[3 * r + c] = s * rotation[3 * r + c];
        seed.least = std::min(seed.least, s);
        seed.most = std::max(seed.most, s);
      }
    }
    seeds.push_back(seed);
  }
  return seeds;
}

SeedSearch::SeedSearch(const std::vector<Seed>& seeds, SeedMetric metric, std::uint32_t count,
                       const Index3& resolution, const TileBuilder& builder)
    : seeds_(seeds), metric_(metric), count_(count), root_{{0, 0, 0}, resolution, {}} {
  std::vector<SeedImage> all;
  all.reserve(seeds.size() * builder.images());
  for (std::uint32_t s = 0; s < seeds.size(); ++s)
    for (std::uint32_t image = 0; image < builder.images(); ++image) {
      SeedImage i{seeds[s].at, s, builder.code(s + 1, image)};
      const auto shift = builder.image_shift(image);
      for (std::size_t a = 0; a < 3; ++a) i.at[a] += shift[a] * std::int32_t(resolution[a]) * kTileUnit;
      all.push_back(i);
    }
  root_.images = cull(all, root_.low, root_.high);
}

double SeedSearch::key(const SeedImage& image, std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
  // Differences of multiples of 1/1024 voxel below 2^22: their squares, and the sum of these, are exact.
  const double d[3] = {centre(x) - image.at[0], centre(y) - image.at[1], centre(z) - image.at[2]};
  const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const Seed& seed = seeds_[image.seed];
  switch (metric_) {
    case SeedMetric::kEuclidean:
      break;
    case SeedMetric::kAnisotropic: {
      double sum = 0;
      for (std::size_t r = 0; r < 9; r += 3) {
        const double u = seed.stretch[r] * d[0] + seed.stretch[r + 1] * d[1] + seed.stretch[r + 2] * d[2];
        sum += u * u;
      }
      return sum;
    }
    case SeedMetric::kAdditive:
      return std::sqrt(d2) - seed.weight;
    case SeedMetric::kMultiplicative:
      return d2 / (seed.weight * seed.weight);
  }
  return d2;
}

SeedSearch::Bounds SeedSearch::bounds(const SeedImage& image, const Index3& low, const Index3& high) const {
  double near = 0, far = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double first = centre(low[a]), last = centre(high[a] - 1), p = image.at[a];
    const double n = std::max({first - p, p - last, 0.0}),
                 f = std::max(std::abs(p - first), std::abs(p - last));
    near += n * n;
    far += f * f;
  }
  const Seed& seed = seeds_[image.seed];
  switch (metric_) {
    case SeedMetric::kEuclidean:
      break;
    case SeedMetric::kAnisotropic:
      return {near * seed.least * seed.least * (1 - kSlack), far * seed.most * seed.most * (1 + kSlack)};
    case SeedMetric::kAdditive:
      return {std::sqrt(near) - seed.weight - 1, std::sqrt(far) - seed.weight + 1};
    case SeedMetric::kMultiplicative: {
      const double w2 = seed.weight * seed.weight;
      return {near / w2 * (1 - kSlack), far / w2 * (1 + kSlack)};
    }
  }
  return {near, far};
}

std::vector<SeedImage> SeedSearch::cull(const std::vector<SeedImage>& from, const Index3& low,
                                        const Index3& high) const {
  // An image whose least key is above the greatest keys of `count` others is not among the nearest anywhere
  // here.
  std::vector<Bounds> all(from.size());
  std::vector<double> greatest(from.size());
  for (std::size_t k = 0; k < from.size(); ++k) {
    all[k] = bounds(from[k], low, high);
    greatest[k] = all[k].high;
  }
  if (from.size() <= count_) return from;
  std::nth_element(greatest.begin(), greatest.begin() + (count_ - 1), greatest.end());
  const double bound = greatest[count_ - 1];
  std::vector<SeedImage> kept;
  for (std::size_t k = 0; k < from.size(); ++k)
    if (all[k].low <= bound) kept.push_back(from[k]);
  return kept;
}

std::vector<SeedSearch::Node> SeedSearch::split(const Node& node) const {
  std::vector<Node> parts{{node.low, node.high, {}}};
  for (std::size_t a = 0; a < 3; ++a) {
    if (node.high[a] - node.low[a] < 2) continue;
    const std::uint32_t middle = (node.low[a] + node.high[a]) / 2;
    const std::size_t count = parts.size();
    for (std::size_t k = 0; k < count; ++k) {
      Node upper = parts[k];
      parts[k].high[a] = middle;
      upper.low[a] = middle;
      parts.push_back(upper);
    }
  }
  for (Node& part : parts) part.images = cull(node.images, part.low, part.high);
  return parts;
}

void SeedSearch::visit(const Node& node, const std::function<void(const Node&)>& fill) const {
  const std::uint64_t voxels =
      std::uint64_t{node.high[0] - node.low[0]} * (node.high[1] - node.low[1]) * (node.high[2] - node.low[2]);
  if (node.images.size() > count_ && voxels > kLeafVoxels)
    for (const Node& part : split(node)) visit(part, fill);
  else
    fill(node);
}

bool SeedSearch::run(unsigned threads, const Progress* progress,
                     const std::function<void(const Node&)>& fill) const {
  // Two levels are split here, so that there is work for every thread.
  std::vector<Node> nodes = split(root_), next;
  for (const Node& node : nodes)
    for (Node& part : split(node)) next.push_back(std::move(part));
  return parallel_for(
      next.size(), threads, [&](std::size_t k, unsigned) { visit(next[k], fill); }, progress, "tile");
}

}  // namespace mesocell
