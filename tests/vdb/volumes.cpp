#include "tests/vdb/volumes.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

namespace mesocell::test {

SparseVolume random_volume(Rng& rng, VolumeType type, VolumeClass volume_class) {
  SparseVolume volume;
  volume.name = "random";
  volume.type = type;
  volume.volume_class = volume_class;
  volume.index_to_world = random_transform(rng);
  if (volume_class == VolumeClass::kLevelSet) volume.background[0] = 1;
  const auto number = [&]() -> double {
    return volume.has_floats() ? double(float(2 * rng.uniform() - 1))
           : volume.has_ints() ? double(rng.below(4))
                               : double(rng.below(2));
  };
  std::set<VoxelCoord> places, nodes;
  const auto place = [&](std::int32_t edge, std::int32_t reach) {
    VoxelCoord at;
    for (std::int32_t& c : at) c = edge * (std::int32_t(rng.below(std::uint32_t(2 * reach))) - reach);
    return at;
  };
  for (int i = 0; i < 40; ++i) {
    const VoxelCoord at = place(8, 4);
    if (!places.insert(at).second) continue;
    nodes.insert({at[0] & ~127, at[1] & ~127, at[2] & ~127});
    if (i % 5 == 0) {
      const double v = number();
      volume.tiles.push_back({at, 3, v != 0, {v, v, v}});
      continue;
    }
    VolumeLeaf leaf{at, {}};
    // Some of one value, so that there is something to tell of them.
    const bool same = i % 3 == 0;
    const double all = number();
    for (unsigned v = 0; v < 512; ++v) {
      const double n = same ? all : number();
      if (n != 0) leaf.active[v / 64] |= std::uint64_t{1} << (v % 64);
      for (std::size_t c = 0; c < volume.channels(); ++c) {
        if (volume.has_floats()) volume.floats.push_back(float(c ? number() : n));
        if (volume.has_ints()) volume.ints.push_back(std::int32_t(n));
      }
    }
    volume.leaves.push_back(leaf);
  }
  for (int i = 0; i < 2; ++i) {
    const VoxelCoord at = place(128, 2);
    const double v = volume_class == VolumeClass::kLevelSet ? -1 : number();
    if (nodes.insert(at).second) volume.tiles.push_back({at, 7, v != 0, {v, v, v}});
  }
  return volume;
}

Transform random_transform(Rng& rng) {
  const Vec3 axis{rng.uniform() + 0.1, rng.uniform(), rng.uniform()};
  Transform shear;
  shear.rows[0].y = rng.uniform() - 0.5;
  shear.rows[2].x = rng.uniform() - 0.5;
  const Vec3 scale{0.1 + rng.uniform(), 0.1 + rng.uniform(), -0.1 - rng.uniform()};
  return translation({10 * rng.uniform(), -3, 7}) * rotation(axis, 6 * rng.uniform()) * shear *
         scaling(scale);
}

SparseVolume ball_volume(double radius, double edge) {
  SparseVolume volume;
  volume.name = "ball";
  volume.volume_class = VolumeClass::kLevelSet;
  volume.index_to_world = scaling({edge, edge, edge});
  const double band = 3 * edge;
  volume.background[0] = double(float(band));
  const std::int32_t reach = std::int32_t(radius / edge) / 8 + 1;
  for (std::int32_t z = -reach; z < reach; ++z)
    for (std::int32_t y = -reach; y < reach; ++y)
      for (std::int32_t x = -reach; x < reach; ++x) {
        VolumeLeaf leaf{{8 * x, 8 * y, 8 * z}, {}};
        std::array<float, 512> values;
        bool any = false;
        for (std::int32_t v = 0; v < 512; ++v) {
          const Vec3 p{double(8 * x + v % 8), double(8 * y + v / 8 % 8), double(8 * z + v / 64)};
          const double distance = length(p) * edge - radius;
          values[std::size_t(v)] = float(std::clamp(distance, -band, band));
          if (std::abs(distance) >= band) continue;
          any = true;
          leaf.active[std::size_t(v / 64)] |= std::uint64_t{1} << (v % 64);
        }
        if (any) {
          volume.leaves.push_back(leaf);
          volume.floats.insert(volume.floats.end(), values.begin(), values.end());
        } else if (values[0] < 0) {
          volume.tiles.push_back({leaf.origin, 3, false, {-double(float(band)), 0, 0}});
        }
      }
  return volume;
}

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace mesocell::test
