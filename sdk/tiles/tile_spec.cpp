#include "sdk/tiles/tile_spec.h"

#include <array>
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

const Generator* find_generator(std::string_view name) {
  for (const Generator& generator : kGenerators)
    if (generator.name == name) return &generator;
  return nullptr;
}

}  // namespace

std::string tile_generator_names() {
  std::string names;
  for (const Generator& g : kGenerators) names += (names.empty() ? "" : ", ") + std::string(g.name);
  return names;
}

bool is_tile_generator(std::string_view name) { return find_generator(name) != nullptr; }

Result<TileMap> make_tile(const Recipe& recipe, unsigned threads, TileReport* report,
                          const Progress* progress) {
  const Generator* generator = find_generator(recipe.name);
  if (!generator)
    return usage("unknown tile generator '" + recipe.name + "'; there are: " + tile_generator_names());
  std::vector<std::string_view> known{"cells", "resolution", "seed"};
  known.insert(known.end(), generator->own.begin(), generator->own.end());
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
  const auto resolution = resolution_option(recipe, "resolution", options.resolution, 4, 1024);
  if (!resolution) return resolution.error();
  options.resolution = *resolution;
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
