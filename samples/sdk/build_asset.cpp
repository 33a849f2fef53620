// Makes an asset from a mesh: `build_asset ball.meso`. The mesh is a ball of 1 m; any closed mesh will do.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>

#include "format/cell_object_io.h"
#include "format/file.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/recipe.h"
#include "sdk/tiles/tile_spec.h"

namespace {

/// A ball of circles of latitude between two poles, triangles counter-clockwise seen from outside.
mesocell::TriangleMesh make_ball(double radius, std::uint32_t rings, std::uint32_t around) {
  mesocell::TriangleMesh mesh;
  const double pi = std::numbers::pi;
  for (std::uint32_t i = 1; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double polar = pi * i / (rings + 1), turn = 2 * pi * j / around;
      mesh.vertices.push_back({radius * std::sin(polar) * std::cos(turn),
                               radius * std::sin(polar) * std::sin(turn), radius * std::cos(polar)});
    }
  const std::uint32_t north = rings * around, south = north + 1;
  mesh.vertices.push_back({0, 0, radius});
  mesh.vertices.push_back({0, 0, -radius});
  for (std::uint32_t j = 0; j < around; ++j) {
    const std::uint32_t k = (j + 1) % around, last = (rings - 1) * around;
    mesh.triangles.push_back({north, j, k});
    mesh.triangles.push_back({south, last + k, last + j});
    for (std::uint32_t i = 0; i + 1 < rings; ++i) {
      const std::uint32_t upper = i * around, lower = upper + around;
      mesh.triangles.push_back({upper + j, lower + j, lower + k});
      mesh.triangles.push_back({upper + j, lower + k, upper + k});
    }
  }
  return mesh;
}

int fail(const mesocell::Error& error) { return std::fprintf(stderr, "%s\n", error.message.c_str()), 3; }

}  // namespace

int main(int argc, char** argv) {
  using namespace mesocell;
  const Result<Recipe> recipe = parse_recipe("voronoi:cells=8,resolution=32,seed=1");
  if (!recipe) return fail(recipe.error());
  Result<TileMap> tile = make_tile(*recipe);
  if (!tile) return fail(tile.error());

  AuthorOptions options;
  options.grid.tiles = 8;  // along the longest side of the mesh
  AuthorReport report;
  Result<CellObject> object = author_cell_object(make_ball(1, 31, 64), std::move(*tile), options, &report);
  if (!object) return fail(object.error());
  for (const Warning& warning : report.warnings) std::fprintf(stderr, "%s\n", warning.text.c_str());
  object->metadata = {{"title", "a ball of cells"}};

  const Result<std::vector<std::byte>> bytes = encode_cell_object(*object);
  if (!bytes) return fail(bytes.error());
  if (const Status status = write_file(argc > 1 ? argv[1] : "ball.meso", *bytes); !status)
    return fail(status.error());
  const InstanceCounts counts = count_instances(object->membership);
  std::printf("%llu cells of the ball, %zu bytes\n", static_cast<unsigned long long>(counts.inside),
              bytes->size());
}
