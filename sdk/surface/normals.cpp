#include "sdk/surface/normals.h"

#include <vector>

#include "format/normal_map.h"
#include "sdk/core/gradient_kernel.h"
#include "sdk/core/parallel.h"

namespace mesocell {
CellNormals::CellNormals(const TileMap& tile) : tile_(tile) {}

bool CellNormals::same_instance(std::uint32_t id, const std::array<std::uint32_t, 3>& voxel,
                                const std::array<std::int32_t, 3>& offset) const {
  std::array<std::uint32_t, 3> at{};
  std::array<std::int32_t, 3> wraps{};
  bool wrapped = false;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t n = std::int32_t(tile_.resolution[a]), x = std::int32_t(voxel[a]) + offset[a];
    wraps[a] = x < 0 ? -1 : x >= n ? 1 : 0;  // the radius is not above the least resolution
    at[a] = std::uint32_t(x - wraps[a] * n);
    wrapped = wrapped || wraps[a] != 0;
  }
  const std::uint32_t other = tile_.id(tile_.voxel_index(at[0], at[1], at[2]));
  if (!wrapped || other == 0) return other == id;
  const Piece &p = tile_.pieces[id - 1], &q = tile_.pieces[other - 1];
  if (p.cell != q.cell) return false;
  for (std::size_t a = 0; a < 3; ++a)
    if (q.home[a] + wraps[a] != p.home[a]) return false;
  return true;
}

Vec3 CellNormals::neighbour_normal(const std::array<std::uint32_t, 3>& voxel) const {
  const std::uint32_t id = tile_.id(tile_.voxel_index(voxel[0], voxel[1], voxel[2]));
  Vec3 sum;
  for (std::int32_t z = -1; z <= 1; ++z)
    for (std::int32_t y = -1; y <= 1; ++y)
      for (std::int32_t x = -1; x <= 1; ++x)
        if ((x != 0 || y != 0 || z != 0) && !same_instance(id, voxel, {x, y, z}))
          sum = sum + normalize({double(x), double(y), double(z)});
  return length(sum) > 1e-9 ? normalize(sum) : Vec3{};
}

Vec3 CellNormals::gradient_normal(const std::array<std::uint32_t, 3>& voxel) const {
  const std::uint32_t id = tile_.id(tile_.voxel_index(voxel[0], voxel[1], voxel[2]));
  Vec3 sum;
  for (const KernelVoxel& n : gradient_kernel())
    if (!same_instance(id, voxel, n.offset)) sum = sum + n.pull;
  if (length(sum) > 1e-3) return normalize(sum);
  const Vec3 near = neighbour_normal(voxel);
  return near == Vec3{} ? Vec3{0, 0, 1} : near;
}

std::optional<NormalMap> make_normal_map(const TileMap& tile, unsigned threads, const Progress* progress) {
  const CellNormals normals(tile);
  const std::vector<std::uint8_t> boundary = boundary_voxels(tile);
  const std::uint64_t slice = std::uint64_t{tile.resolution[0]} * tile.resolution[1];
  std::vector<std::uint64_t> first{0};
  for (std::uint32_t z = 0; z < tile.resolution[2]; ++z) {
    std::uint64_t count = 0;
    for (std::uint64_t i = z * slice; i < (z + 1) * slice; ++i) count += boundary[i];
    first.push_back(first.back() + count);
  }
  NormalMap map;
  map.normals.resize(first.back());
  const bool done = parallel_for(
      tile.resolution[2], threads,
      [&](std::size_t z, unsigned) {
        std::uint64_t next = first[z];
        for (std::uint64_t i = 0; i < slice; ++i)
          if (boundary[z * slice + i])
            map.normals[next++] = encode_normal(to_array(normals.gradient_normal(
                {std::uint32_t(i % tile.resolution[0]), std::uint32_t(i / tile.resolution[0]), std::uint32_t(z)})));
      },
      progress, "normals");
  if (!done) return std::nullopt;
  return map;
}

}  // namespace mesocell
