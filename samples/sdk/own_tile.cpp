// A tile generator of one's own: truncated octahedra with gaps, the foam of least surface that Kelvin knew,
// and a box made of it: `own_tile foam.meso`.
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "format/cell_object_io.h"
#include "format/file.h"
#include "sdk/author/cell_object.h"
#include "sdk/tiles/tile_builder.h"

namespace {

/// Two cells, about the tile's corner and its middle; a voxel goes to the nearest image of either. Voxels
/// whose two nearest images are almost equally far, by `gap` in squared tile edges, stay empty.
mesocell::TileMap make_foam(std::uint32_t n, double gap) {
  constexpr std::array<double, 2> kSeeds{0, 0.5};  // the same on all three axes
  mesocell::TileBuilder builder({n, n, n}, kSeeds.size());
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        double nearest = std::numeric_limits<double>::max(), second = nearest;
        std::uint32_t code = 0;
        for (std::uint32_t cell = 1; cell <= kSeeds.size(); ++cell)
          for (std::uint32_t image = 0; image < builder.images(); ++image) {
            const auto shift = builder.image_shift(image);
            double distance = 0;
            for (std::size_t a = 0; a < 3; ++a) {
              const double p = ((a == 0 ? x : a == 1 ? y : z) + 0.5) / n;
              const double d = p - kSeeds[cell - 1] - shift[a];
              distance += d * d;
            }
            if (distance < nearest) {
              second = nearest;
              nearest = distance;
              code = builder.code(cell, image);
            } else if (distance < second) {
              second = distance;
            }
          }
        if (second - nearest > gap) builder.set(x + std::uint64_t{n} * (y + std::uint64_t{n} * z), code);
      }
  return builder.finish(0, nullptr);
}

mesocell::TriangleMesh make_box(double side) {
  mesocell::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({side * (i & 1), side * (i >> 1 & 1), side * (i >> 2 & 1)});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

int fail(const mesocell::Error& error) { return std::fprintf(stderr, "%s\n", error.message.c_str()), 3; }

}  // namespace

int main(int argc, char** argv) {
  using namespace mesocell;
  AuthorOptions options;
  options.grid.tiles = 4;
  const Result<CellObject> object = author_cell_object(make_box(1), make_foam(32, 0.03), options);
  if (!object) return fail(object.error());
  const Result<std::vector<std::byte>> bytes = encode_cell_object(*object);
  if (!bytes) return fail(bytes.error());
  if (const Status status = write_file(argc > 1 ? argv[1] : "foam.meso", *bytes); !status)
    return fail(status.error());
  const InstanceCounts counts = count_instances(object->membership);
  std::printf("%llu of 128 cells inside, %zu bytes\n", static_cast<unsigned long long>(counts.inside),
              bytes->size());
}
