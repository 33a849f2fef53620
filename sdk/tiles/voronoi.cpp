#include <limits>
#include <string>
#include <string_view>

#include "sdk/tiles/seed_search.h"

namespace mesocell {
namespace {

struct Metric {
  std::string_view name;
  SeedMetric metric;
  std::int32_t reach;  ///< tiles to the farthest image that can be nearest
};
constexpr Metric kMetrics[] = {
    {"euclidean", SeedMetric::kEuclidean, 1},
    {"anisotropic", SeedMetric::kAnisotropic, 2},
    {"additive", SeedMetric::kAdditive, 1},
    {"multiplicative", SeedMetric::kMultiplicative, 1},
};

}  // namespace

Result<TileMap> make_voronoi_tile(const GeneratorOptions& options, TileReport* report) {
  const auto given = options.recipe.options.find("metric");
  const std::string name = given == options.recipe.options.end() ? "euclidean" : given->second;
  const Metric* metric = nullptr;
  std::string names;
  for (const Metric& m : kMetrics) {
    if (m.name == name) metric = &m;
    names += (names.empty() ? "" : ", ") + std::string(m.name);
  }
  if (!metric) return Error{ErrorCode::kUsage, "metric=" + name + " is not one of: " + names};

  const std::vector<Seed> seeds = random_seeds(options, metric->metric);
  TileBuilder builder(options.resolution, options.cells, metric->reach);
  const SeedSearch search(seeds, metric->metric, 1, options.resolution, builder);
  const Index3& n = options.resolution;
  const bool done = search.run(options.threads, options.progress, [&](const SeedSearch::Node& node) {
    for (std::uint32_t z = node.low[2]; z < node.high[2]; ++z)
      for (std::uint32_t y = node.low[1]; y < node.high[1]; ++y)
        for (std::uint32_t x = node.low[0]; x < node.high[0]; ++x) {
          double least = std::numeric_limits<double>::infinity();
          std::uint32_t code = 0;
          for (const SeedImage& image : node.images) {
            const double key = node.images.size() == 1 ? 0 : search.key(image, x, y, z);
            // Strictly less: images ascend by code, so a tie stays with the lower one.
            if (key < least) {
              least = key;
              code = image.code;
            }
          }
          builder.set(x + std::uint64_t{n[0]} * (y + std::uint64_t{n[1]} * z), code);
        }
  });
  if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
  return builder.finish(options.threads, report);
}

}  // namespace mesocell
