#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sdk/tiles/generators.h"

namespace mesocell {

/// How far a point is from a seed. Keys only order: their units differ between metrics.
enum class SeedMetric : std::uint8_t {
  kEuclidean,       ///< key: |d|²
  kAnisotropic,     ///< key: |A·d|²
  kAdditive,        ///< key: |d| - w
  kMultiplicative,  ///< key: |d|² / w²
};

/// A seed's share in the metric. Lengths in 1/1024 voxel.
struct Seed {
  TilePoint at{};
  double weight = 0;                ///< w, for the weighted metrics
  std::array<double, 9> stretch{};  ///< A by rows, for the anisotropic one
  double least = 1, most = 1;       ///< |A·d| / |d| is between these
};

/// Random seeds of a tile, as random_tile_points() places them, with what the metric needs: weights,
/// stretches.
[[nodiscard]] std::vector<Seed> random_seeds(const GeneratorOptions& options, SeedMetric metric);

/// Mean distance between the seeds of a tile: the edge of a cube of a cell's volume. In 1/1024 voxel.
[[nodiscard]] double mean_spacing(const GeneratorOptions& options);

/// A periodic image of a seed.
struct SeedImage {
  TilePoint at{};
  std::uint32_t seed = 0;  ///< its index
  std::uint32_t code = 0;  ///< what TileBuilder calls it
};

/// Finds the seed images nearest to the voxels of a tile, by octants in which most can be ruled out at once.
class SeedSearch {
 public:
  /// A box of voxels [low, high) and every image that may be among the nearest to one of their centres, by
  /// code.
  struct Node {
    Index3 low{}, high{};
    std::vector<SeedImage> images;
  };

  /// `count`: how many of the nearest matter. Images are those of `builder`.
  SeedSearch(const std::vector<Seed>& seeds, SeedMetric metric, std::uint32_t count, const Index3& resolution,
             const TileBuilder& builder);

  /// Calls `fill` once for small boxes that cover the tile, from several threads; false if cancelled.
  bool run(unsigned threads, const Progress* progress, const std::function<void(const Node&)>& fill) const;

  /// The key of an image at a voxel's centre. Evaluated in one order, so it is the same on every machine.
  [[nodiscard]] double key(const SeedImage& image, std::uint32_t x, std::uint32_t y, std::uint32_t z) const;

 private:
  struct Bounds {
    double low, high;
  };
  [[nodiscard]] Bounds bounds(const SeedImage& image, const Index3& low, const Index3& high) const;
  [[nodiscard]] std::vector<SeedImage> cull(const std::vector<SeedImage>& from, const Index3& low,
                                            const Index3& high) const;
  [[nodiscard]] std::vector<Node> split(const Node& node) const;
  void visit(const Node& node, const std::function<void(const Node&)>& fill) const;

  const std::vector<Seed>& seeds_;
  SeedMetric metric_;
  std::uint32_t count_;
  Node root_;
};

}  // namespace mesocell
