#include <algorithm>
#include <limits>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/generators.h"

namespace mesocell {
namespace {

/// An image of a seed, with the code that its voxels get.
struct Candidate {
  TilePoint at;
  std::uint32_t code;
};

/// A box of voxels [low, high) and every seed image that may be nearest to one of their centres, by code.
struct Node {
  Index3 low, high;
  std::vector<Candidate> candidates;
};

std::int64_t square(std::int64_t x) { return x * x; }

std::int32_t centre(std::uint32_t voxel) { return std::int32_t(voxel) * kTileUnit + kTileUnit / 2; }

/// Drops the candidates that are farther from all centres in the box than some other is from any of them.
std::vector<Candidate> cull(const std::vector<Candidate>& from, const Index3& low, const Index3& high) {
  std::int64_t bound = std::numeric_limits<std::int64_t>::max();
  std::vector<std::int64_t> nearest(from.size());
  for (std::size_t k = 0; k < from.size(); ++k) {
    std::int64_t near = 0, far = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t first = centre(low[a]), last = centre(high[a] - 1), p = from[k].at[a];
      near += square(std::max<std::int64_t>({first - p, p - last, 0}));
      far += square(std::max(std::abs(p - first), std::abs(p - last)));
    }
    nearest[k] = near;
    bound = std::min(bound, far);
  }
  std::vector<Candidate> kept;
  for (std::size_t k = 0; k < from.size(); ++k)
    if (nearest[k] <= bound) kept.push_back(from[k]);
  return kept;
}

/// The octants of a node (fewer where a side is one voxel).
std::vector<Node> split(const Node& node) {
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
  for (Node& part : parts) part.candidates = cull(node.candidates, part.low, part.high);
  return parts;
}

std::uint32_t nearest_code(const std::vector<Candidate>& candidates, std::int64_t x, std::int64_t y,
                           std::int64_t z) {
  std::int64_t best = std::numeric_limits<std::int64_t>::max();
  std::uint32_t code = 0;
  for (const Candidate& c : candidates) {
    const std::int64_t d = square(x - c.at[0]) + square(y - c.at[1]) + square(z - c.at[2]);
    // Strictly less: candidates ascend by code, so a tie stays with the lower one.
    if (d < best) {
      best = d;
      code = c.code;
    }
  }
  return code;
}

void fill(const Node& node, const Index3& resolution, TileBuilder& builder) {
  const std::uint64_t voxels =
      std::uint64_t{node.high[0] - node.low[0]} * (node.high[1] - node.low[1]) * (node.high[2] - node.low[2]);
  if (node.candidates.size() > 1 && voxels > 64) {
    for (const Node& part : split(node)) fill(part, resolution, builder);
    return;
  }
  for (std::uint32_t z = node.low[2]; z < node.high[2]; ++z)
    for (std::uint32_t y = node.low[1]; y < node.high[1]; ++y) {
      const std::uint64_t row = std::uint64_t{resolution[0]} * (y + std::uint64_t{resolution[1]} * z);
      for (std::uint32_t x = node.low[0]; x < node.high[0]; ++x)
        builder.set(row + x, node.candidates.size() == 1
                                 ? node.candidates[0].code
                                 : nearest_code(node.candidates, centre(x), centre(y), centre(z)));
    }
}

}  // namespace

std::vector<TilePoint> random_tile_points(const GeneratorOptions& options, std::uint32_t count) {
  Rng rng(options.seed);
  std::vector<TilePoint> points(count);
  for (TilePoint& p : points)
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = std::int32_t(rng.bits(32) * options.resolution[a] * std::uint64_t{kTileUnit} >> 32);
  return points;
}

Result<TileMap> make_voronoi_tile(const GeneratorOptions& options, TileReport* report) {
  const std::vector<TilePoint> seeds = random_tile_points(options, options.cells);
  TileBuilder builder(options.resolution, options.cells);

  Node root{{0, 0, 0}, options.resolution, {}};
  root.candidates.reserve(seeds.size() * TileBuilder::kImages);
  for (std::uint32_t cell = 1; cell <= options.cells; ++cell)
    for (std::uint32_t image = 0; image < TileBuilder::kImages; ++image) {
      Candidate c{seeds[cell - 1], TileBuilder::code(cell, image)};
      const auto shift = TileBuilder::image_shift(image);
      for (std::size_t a = 0; a < 3; ++a)
        c.at[a] += shift[a] * std::int32_t(options.resolution[a]) * kTileUnit;
      root.candidates.push_back(c);
    }
  root.candidates = cull(root.candidates, root.low, root.high);

  // Two levels are split here, so that there is work for every thread.
  std::vector<Node> nodes{std::move(root)};
  for (int level = 0; level < 2; ++level) {
    std::vector<Node> next;
    for (const Node& node : nodes)
      for (Node& part : split(node)) next.push_back(std::move(part));
    nodes = std::move(next);
  }
  if (!parallel_for(
          nodes.size(), options.threads,
          [&](std::size_t k, unsigned) { fill(nodes[k], options.resolution, builder); }, options.progress,
          "tile"))
    return Error{ErrorCode::kCancelled, "cancelled"};
  return builder.finish(options.threads, report);
}

}  // namespace mesocell
