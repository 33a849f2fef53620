// Parity along an axis: a voxel is inside if an odd number of triangles lies beyond its centre.
#include "converters/stability/methods/crossings.h"
#include "converters/stability/voxelizer.h"
#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

/// Turns marks into parities: bit i becomes the sum of the bits from i on, modulo 2.
void sum_to_end(std::span<std::uint64_t> row) {
  std::uint64_t beyond = 0;  // all bits as the sum of the words behind
  for (std::size_t k = row.size(); k-- > 0;) {
    std::uint64_t w = row[k];
    for (int shift = 1; shift < 64; shift *= 2) w ^= w >> shift;
    row[k] = w ^ beyond;
    beyond = row[k] & 1 ? ~std::uint64_t{0} : 0;
  }
}

void add_row(std::span<std::uint64_t> row, std::span<const std::uint64_t> next) {
  for (std::size_t k = 0; k < row.size(); ++k) row[k] ^= next[k];
}

Status voxelize(const TriangleMesh& mesh, std::size_t axis, BitGrid& out, unsigned threads) {
  const CrossingFinder finder(mesh, axis, out.size());
  // A chunk owns whole rows of the grid or, along z, whole columns of rows.
  parallel_for(finder.chunks(), threads, [&](std::size_t chunk, unsigned) {
    std::vector<Crossing> crossings;
    finder.find(chunk, crossings);
    for (const Crossing& c : crossings) {
      if (c.slice == 0) continue;
      const std::uint32_t last = c.slice - 1;
      if (axis == 0) out.toggle(last, c.u, c.v);
      if (axis == 1) out.toggle(c.u, last, c.v);
      if (axis == 2) out.toggle(c.u, c.v, last);
    }
    const auto [begin, end] = finder.rows(chunk);
    const Index3& size = out.size();
    for (std::uint32_t v = begin; v < end; ++v) {
      if (axis == 0)
        for (std::uint32_t y = 0; y < size[1]; ++y) sum_to_end(out.row(y, v));
      if (axis == 1)
        for (std::uint32_t y = size[1] - 1; y-- > 0;) add_row(out.row(y, v), out.row(y + 1, v));
      if (axis == 2)
        for (std::uint32_t z = size[2] - 1; z-- > 0;) add_row(out.row(v, z), out.row(v, z + 1));
    }
  });
  return {};
}

}  // namespace

Status voxelize_parity_x(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  return voxelize(mesh, 0, out, threads);
}
Status voxelize_parity_y(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  return voxelize(mesh, 1, out, threads);
}
Status voxelize_parity_z(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  return voxelize(mesh, 2, out, threads);
}

}  // namespace mesocell
