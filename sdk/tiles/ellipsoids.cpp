#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/tiles/packing.h"
#include "sdk/tiles/random_rotation.h"

namespace mesocell {
namespace {

/// Points p with |A·(p - centre)| < radius; A shortens no vector, so the sphere of that radius holds it.
struct Ellipsoid {
  Sphere sphere;
  std::array<double, 9> a{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

bool contains(const Ellipsoid& e, const std::array<double, 3>& d) {
  double sum = 0;
  for (std::size_t r = 0; r < 9; r += 3) {
    const double u = e.a[r] * d[0] + e.a[r + 1] * d[1] + e.a[r + 2] * d[2];
    sum += u * u;
  }
  return sum < e.sphere.radius * e.sphere.radius;
}

/// Gives the voxels whose centres are in ellipsoid `k` to cell k + 1. Returns whether there are any.
bool fill(const Ellipsoid& e, std::uint32_t k, const Index3& n, TileBuilder& builder) {
  bool any = false;
  std::array<std::int32_t, 3> low{}, high{}, v{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::int32_t(std::floor((e.sphere.centre[a] - e.sphere.radius) / kTileUnit));
    high[a] = std::int32_t(std::ceil((e.sphere.centre[a] + e.sphere.radius) / kTileUnit));
  }
  for (v[2] = low[2]; v[2] < high[2]; ++v[2])
    for (v[1] = low[1]; v[1] < high[1]; ++v[1])
      for (v[0] = low[0]; v[0] < high[0]; ++v[0]) {
        std::array<double, 3> d{};
        std::array<std::int32_t, 3> shift{}, in_tile{};
        for (std::size_t a = 0; a < 3; ++a) {
          d[a] = double(v[a]) * kTileUnit + kTileUnit / 2 - e.sphere.centre[a];
          const std::int32_t size = std::int32_t(n[a]), tile = v[a] < 0 ? -1 : v[a] >= size ? 1 : 0;
          in_tile[a] = v[a] - tile * size;
          shift[a] = -tile;  // seen from the voxel in this tile, the centre is that far away
        }
        if (!contains(e, d)) continue;
        builder.set(std::uint64_t(in_tile[0]) +
                        std::uint64_t{n[0]} *
                            (std::uint64_t(in_tile[1]) + std::uint64_t{n[1]} * std::uint64_t(in_tile[2])),
                    builder.code(k + 1, builder.image_index(shift[0], shift[1], shift[2])));
        any = true;
      }
  return any;
}

Result<TileMap> make_tile_of(const std::vector<Ellipsoid>& ellipsoids, const GeneratorOptions& options,
                             TileReport* report) {
  TileBuilder builder(options.resolution, options.cells);
  std::atomic<bool> any{false};
  // They are disjoint, so each can be filled on its own.
  const bool done = parallel_for(
      ellipsoids.size(), options.threads,
      [&](std::size_t k, unsigned) {
        if (fill(ellipsoids[k], std::uint32_t(k), options.resolution, builder)) any = true;
      },
      options.progress, "tile");
  if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
  if (!any)
    return Error{ErrorCode::kUsage,
                 "no cell of this tile holds a voxel centre; use fewer cells or a higher resolution"};
  return builder.finish(options.threads, report);
}

}  // namespace

Result<TileMap> make_spheres_tile(const GeneratorOptions& options, TileReport* report) {
  std::vector<Ellipsoid> balls;
  for (const Sphere& s : pack_spheres(options)) balls.push_back({s});
  return make_tile_of(balls, options, report);
}

Result<TileMap> make_ellipsoids_tile(const GeneratorOptions& options, TileReport* report) {
  const Result<double> flatness = number_option(options.recipe, "flatness", 0.6, 0, 0.95);
  if (!flatness) return flatness.error();
  Rng rng(~options.seed);
  std::vector<Ellipsoid> ellipsoids;
  for (const Sphere& s : pack_spheres(options)) {
    Ellipsoid e{s};
    const Rotation rotation = random_rotation(rng);
    const double shortest = rng.uniform(1 - *flatness, 1);
    const double axes[3] = {1, rng.uniform(shortest, 1), shortest};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) e.a[3 * r + c] = rotation[3 * r + c] / axes[r];
    ellipsoids.push_back(e);
  }
  return make_tile_of(ellipsoids, options, report);
}

}  // namespace mesocell
