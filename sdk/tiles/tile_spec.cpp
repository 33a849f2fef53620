#include "sdk/tiles/tile_spec.h"

#include <array>
#include <charconv>
#include <optional>
#include <vector>

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

/// "128" or "96x64x128".
std::optional<Index3> to_resolution(std::string_view text) {
  const auto number = [](std::string_view part) -> std::optional<std::uint32_t> {
    std::uint32_t n = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), n);
    if (error != std::errc{} || end != part.data() + part.size() || n < 4 || n > 1024) return std::nullopt;
    return n;
  };
  if (const auto all = number(text)) return Index3{*all, *all, *all};
  Index3 r{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t x = text.find('x');
    if ((x == std::string_view::npos) != (a == 2)) return std::nullopt;
    const auto n = number(text.substr(0, x));
    if (!n) return std::nullopt;
    r[a] = *n;
    if (a < 2) text.remove_prefix(x + 1);
  }
  return r;
}

}  // namespace

Result<TileMap> make_tile(const Recipe& recipe, unsigned threads, TileReport* report,
                          const Progress* progress) {
  const Generator* generator = nullptr;
  std::string names;
  for (const Generator& g : kGenerators) {
    if (g.name == recipe.name) generator = &g;
    names += (names.empty() ? "" : ", ") + std::string(g.name);
  }
  if (!generator) return usage("unknown tile generator '" + recipe.name + "'; there are: " + names);
  std::vector<std::string_view> known{"cells", "resolution", "seed"};
  for (const std::string_view own : generator->own)
    if (!own.empty()) known.push_back(own);
  if (const Status status = check_options(recipe, "tile generator", known); !status) return status.error();

  GeneratorOptions options;
  options.recipe = recipe;
  options.threads = threads;
  options.progress = progress;
  const auto cells = whole_option(recipe, "cells", options.cells, 1, 65535);
  if (!cells) return cells.error();
  options.cells = std::uint32_t(*cells);
  const auto seed = whole_option(recipe, "seed", options.seed, 0, ~std::uint64_t{0});
  if (!seed) return seed.error();
  options.seed = *seed;
  if (const auto given = recipe.options.find("resolution"); given != recipe.options.end()) {
    const auto resolution = to_resolution(given->second);
    if (!resolution)
      return usage("resolution=" + given->second +
                   " is not a number of voxels from 4 to 1024, nor WxHxD of such");
    options.resolution = *resolution;
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
