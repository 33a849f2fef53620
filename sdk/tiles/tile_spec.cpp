#include "sdk/tiles/tile_spec.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <optional>
#include <span>

#include "sdk/tiles/generators.h"

namespace mesocell {
namespace {

struct Generator {
  std::string_view name;
  std::string_view help;
  std::array<std::string_view, 3> own;  ///< its own options, the rest empty
  std::string_view own_help;
  Result<TileMap> (*make)(const GeneratorOptions&, TileReport*);
};

constexpr Generator kGenerators[] = {
    {"voronoi",
     "cells nearest to random seeds; no empty space",
     {"metric"},
     "metric=euclidean|anisotropic|additive|multiplicative",
     make_voronoi_tile},
    {"spheres", "packed spheres in empty space", {}, "", make_spheres_tile},
    {"ellipsoids",
     "packed ellipsoids in empty space",
     {"flatness"},
     "flatness=0…0.95 (0.6)",
     make_ellipsoids_tile},
    {"worley",
     "cells cut from distances F1…F4 to the nearest seeds",
     {"combine", "threshold", "keep"},
     "combine=f2-f1, threshold=0.1, keep=above|below",
     make_worley_tile},
    {"bricks",
     "running bond with mortar as empty space",
     {"mortar", "courses"},
     "mortar=0…0.9 (0.1), courses=an even number",
     make_bricks_tile},
};

Error usage(std::string text) { return {ErrorCode::kUsage, std::move(text)}; }

template <typename T>
std::optional<T> to_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "128" or "96x64x128".
std::optional<Index3> to_resolution(std::string_view text) {
  if (const auto all = to_number<std::uint32_t>(text)) return Index3{*all, *all, *all};
  Index3 r{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t x = text.find('x');
    if ((x == std::string_view::npos) != (a == 2)) return std::nullopt;
    const auto n = to_number<std::uint32_t>(text.substr(0, x));
    if (!n) return std::nullopt;
    r[a] = *n;
    if (a < 2) text.remove_prefix(x + 1);
  }
  return r;
}

}  // namespace

Result<double> own_number(const GeneratorOptions& options, const std::string& name, double fallback,
                          double low, double high) {
  const auto given = options.own.find(name);
  if (given == options.own.end()) return fallback;
  const auto number = to_number<double>(given->second);
  if (!number || !(*number >= low && *number <= high)) {
    char range[64];
    std::snprintf(range, sizeof range, "%g to %g", low, high);
    return usage(name + "=" + given->second + " is not a number from " + range);
  }
  return *number;
}

Result<TileSpec> parse_tile_spec(std::string_view text) {
  TileSpec spec;
  const std::size_t colon = text.find(':');
  spec.generator = text.substr(0, colon);
  if (spec.generator.empty()) return usage("a tile recipe begins with a generator, as in voronoi:cells=8");
  if (colon == std::string_view::npos) return spec;
  text.remove_prefix(colon + 1);
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == item.size())
      return usage("tile option '" + std::string(item) + "' is not of the form name=value");
    if (!spec.options.emplace(item.substr(0, equals), item.substr(equals + 1)).second)
      return usage("tile option '" + std::string(item.substr(0, equals)) + "' is given twice");
    if (comma == std::string_view::npos) return spec;
    text.remove_prefix(comma + 1);
  }
}

Result<TileMap> make_tile(const TileSpec& spec, unsigned threads, TileReport* report,
                          const Progress* progress) {
  const Generator* generator = nullptr;
  for (const Generator& g : kGenerators)
    if (g.name == spec.generator) generator = &g;
  if (!generator) {
    std::string names;
    for (const Generator& g : kGenerators) names += (names.empty() ? "" : ", ") + std::string(g.name);
    return usage("unknown tile generator '" + spec.generator + "'; there are: " + names);
  }
  GeneratorOptions options;
  options.threads = threads;
  options.progress = progress;
  for (const auto& [name, value] : spec.options) {
    if (name == "cells") {
      const auto n = to_number<std::uint32_t>(value);
      if (!n || *n < 1 || *n > 65535) return usage("cells=" + value + " is not a number from 1 to 65535");
      options.cells = *n;
    } else if (name == "resolution") {
      const auto r = to_resolution(value);
      bool good = r.has_value();
      for (std::size_t a = 0; good && a < 3; ++a) good = (*r)[a] >= 4 && (*r)[a] <= 1024;
      if (!good)
        return usage("resolution=" + value + " is not a number of voxels from 4 to 1024, nor WxHxD of such");
      options.resolution = *r;
    } else if (name == "seed") {
      const auto n = to_number<std::uint64_t>(value);
      if (!n) return usage("seed=" + value + " is not a whole number from 0 to 2^64-1");
      options.seed = *n;
    } else if (std::find(generator->own.begin(), generator->own.end(), name) == generator->own.end()) {
      std::string names = "cells, resolution, seed";
      for (const std::string_view own : generator->own) names += (own.empty() ? "" : ", ") + std::string(own);
      return usage("tile generator " + spec.generator + " has no option '" + name + "'; it has: " + names);
    } else {
      options.own.emplace(name, value);
    }
  }
  const std::uint64_t voxels =
      std::uint64_t{options.resolution[0]} * options.resolution[1] * options.resolution[2];
  if (options.cells > voxels)
    return usage("cells=" + std::to_string(options.cells) + " are more than the tile's " +
                 std::to_string(voxels) + " voxels; use fewer cells or a higher resolution");
  return generator->make(options, report);
}

std::string tile_generators_help() {
  std::string text;
  for (const Generator& g : kGenerators) {
    text += std::string(g.name) + ":cells=8,resolution=64,seed=1   " + std::string(g.help) + "\n";
    if (!g.own_help.empty()) text += "    " + std::string(g.own_help) + "\n";
  }
  return text + "cells: 1…65535; resolution: voxels per axis, 4…1024, or WxHxD; seed: any whole number\n";
}

}  // namespace mesocell
