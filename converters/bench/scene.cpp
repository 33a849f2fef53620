#include "converters/bench/scene.h"

#include <array>
#include <charconv>

#include "sdk/author/cell_object.h"
#include "sdk/core/shapes.h"
#include "sdk/tiles/tile_spec.h"

namespace mesocell {
namespace {

constexpr std::array<BenchTile, 4> kTiles = {{
    {"voronoi", "voronoi:cells=8,seed=16"},
    {"bricks", "bricks:cells=8,seed=1"},
    {"worley", "worley:cells=8,seed=1"},
    {"ellipsoids", "ellipsoids:cells=8,seed=1"},
}};
constexpr std::uint32_t kMin = 4, kMax = 256;

template <typename Range>
std::string names_of(const Range& range) {
  std::string names;
  for (const auto& entry : range) names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names;
}

template <typename Range>
const auto* find_name(const Range& range, std::string_view name) {
  for (const auto& entry : range)
    if (entry.name == name) return &entry;
  return static_cast<decltype(&*range.begin())>(nullptr);
}

bool to_count(std::string_view text, std::uint32_t& count) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  return error == std::errc() && end == text.data() + text.size() && count >= kMin && count <= kMax;
}

}  // namespace

std::span<const BenchTile> bench_tiles() { return kTiles; }

std::string SceneName::text() const {
  return shape + "-" + tile + "-" + std::to_string(tiles) + "x" + std::to_string(resolution);
}

Result<SceneName> parse_scene_name(std::string_view text) {
  const std::size_t first = text.find('-'), second = text.find('-', first + 1), x = text.rfind('x');
  SceneName name;
  const bool split = first != text.npos && second != text.npos && x != text.npos && x > second;
  if (split) {
    name.shape = text.substr(0, first);
    name.tile = text.substr(first + 1, second - first - 1);
  }
  if (!split || !find_shape(name.shape) || !find_name(bench_tiles(), name.tile) ||
      !to_count(text.substr(second + 1, x - second - 1), name.tiles) ||
      !to_count(text.substr(x + 1), name.resolution))
    return Error{ErrorCode::kUsage, "there is no scene '" + std::string(text) +
                                        "'; a scene is SHAPE-TILE-TILESxRESOLUTION such as " +
                                        "wavy-voronoi-64x32, with both numbers from 4 to 256; shapes: " +
                                        names_of(shapes()) + "; tiles: " + names_of(bench_tiles())};
  return name;
}

Result<CellObject> make_scene(const SceneName& name, unsigned threads, const Progress& progress) {
  const Shape& shape = *find_shape(name.shape);
  const BenchTile& tile = *find_name(bench_tiles(), name.tile);
  const Result<Recipe> recipe =
      parse_recipe(std::string(tile.recipe) + ",resolution=" + std::to_string(name.resolution));
  if (!recipe) return recipe.error();
  Result<TileMap> map = make_tile(*recipe, threads, nullptr, &progress);
  if (!map) return map.error();
  AuthorOptions options;
  options.grid.tiles = name.tiles;
  options.grid.box = Box3{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  options.repair.repair = Repair::kStrict;
  options.threads = threads;
  return author_cell_object(shape.make(1), std::move(*map), options, nullptr, &progress);
}

}  // namespace mesocell
