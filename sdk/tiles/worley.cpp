#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "sdk/tiles/seed_search.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kNearest = 4;
using Combination = std::array<double, kNearest>;

Error worley_usage(std::string text) { return {ErrorCode::kUsage, std::move(text)}; }

/// A sum such as "f2-f1" or "0.5*f1+f3", as factors of F1…F4.
Result<Combination> parse_combination(std::string_view text) {
  const Error error = worley_usage("combine=" + std::string(text) +
                                   " is not a sum of f1, f2, f3, f4, as in f2-f1 or 2*f3-f1");
  Combination sum{};
  bool first = true;
  while (!text.empty() || first) {
    double sign = 1;
    if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
      sign = text[0] == '-' ? -1 : 1;
      text.remove_prefix(1);
    } else if (!first) {
      return error;
    }
    first = false;
    double factor = 1;
    const std::size_t star = text.substr(0, text.find_first_of("+-")).find('*');
    if (star != std::string_view::npos) {
      const auto [end, failed] = std::from_chars(text.data(), text.data() + star, factor);
      if (failed != std::errc{} || end != text.data() + star || !std::isfinite(factor)) return error;
      text.remove_prefix(star + 1);
    }
    if (text.size() < 2 || text[0] != 'f' || text[1] < '1' || text[1] > '4') return error;
    sum[std::size_t(text[1] - '1')] += sign * factor;
    text.remove_prefix(2);
  }
  return sum;
}

/// The least keys of a voxel, and the code of the nearest image.
struct Nearest {
  std::array<double, kNearest> keys;
  std::uint32_t code = 0;
};

Nearest nearest_images(const SeedSearch& search, const SeedSearch::Node& node, std::uint32_t x,
                       std::uint32_t y, std::uint32_t z) {
  Nearest n;
  n.keys.fill(std::numeric_limits<double>::infinity());
  for (const SeedImage& image : node.images) {
    double key = search.key(image, x, y, z);
    if (key < n.keys[0]) n.code = image.code;
    for (double& k : n.keys)
      if (key < k) std::swap(key, k);
  }
  return n;
}

}  // namespace

Result<TileMap> make_worley_tile(const GeneratorOptions& options, TileReport* report) {
  const auto own = [&](const char* name, const char* fallback) {
    const auto given = options.recipe.options.find(name);
    return given == options.recipe.options.end() ? std::string(fallback) : given->second;
  };
  const Result<Combination> factors = parse_combination(own("combine", "f2-f1"));
  if (!factors) return factors.error();
  const Result<double> threshold = number_option(options.recipe, "threshold", 0.1, -100, 100);
  if (!threshold) return threshold.error();
  const std::string keep = own("keep", "above");
  if (keep != "above" && keep != "below") return worley_usage("keep=" + keep + " is not above or below");

  const std::vector<Seed> seeds = random_seeds(options, SeedMetric::kEuclidean);
  const double limit = *threshold * mean_spacing(options);
  TileBuilder builder(options.resolution, options.cells);
  const SeedSearch search(seeds, SeedMetric::kEuclidean, kNearest, options.resolution, builder);
  const Index3& n = options.resolution;
  std::atomic<bool> any{false};
  const bool done = search.run(options.threads, options.progress, [&](const SeedSearch::Node& node) {
    for (std::uint32_t z = node.low[2]; z < node.high[2]; ++z)
      for (std::uint32_t y = node.low[1]; y < node.high[1]; ++y)
        for (std::uint32_t x = node.low[0]; x < node.high[0]; ++x) {
          const Nearest nearest = nearest_images(search, node, x, y, z);
          double sum = 0;
          for (std::size_t k = 0; k < kNearest; ++k) sum += (*factors)[k] * std::sqrt(nearest.keys[k]);
          if ((sum > limit) != (keep == "above")) continue;
          builder.set(x + std::uint64_t{n[0]} * (y + std::uint64_t{n[1]} * z), nearest.code);
          any = true;
        }
  });
  if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
  if (!any)
    return worley_usage(
        "this threshold leaves the tile empty; F1 is about half, F2 to F4 up to one mean distance");
  return builder.finish(options.threads, report);
}

}  // namespace mesocell
