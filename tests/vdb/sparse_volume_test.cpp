#include "converters/vdb/sparse_volume.h"

#include <limits>

#include "converters/vdb/volume_lookup.h"
#include "tests/support/catch.h"
#include "tests/vdb/volumes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

std::vector<std::byte> bytes_of(const SparseVolume& volume) {
  ByteWriter out;
  write_volume(volume, out);
  return out.release();
}

Result<SparseVolume> read(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  return read_volume(in);
}

}  // namespace

TEST_CASE("sparse volume: bytes and back") {
  Rng rng(1);
  for (const VolumeType type :
       {VolumeType::kFloat, VolumeType::kFloat3, VolumeType::kInt, VolumeType::kInt3, VolumeType::kMask}) {
    SparseVolume volume = random_volume(rng, type, VolumeClass::kFog);
    volume.metadata = {{"a", "b"}, {"", "c"}};
    const auto bytes = bytes_of(volume);
    const auto back = read(bytes);
    REQUIRE(back);
    CHECK(bytes_of(*back) == bytes);
    CHECK(back->metadata == volume.metadata);
    CHECK(back->floats == volume.floats);
    CHECK(back->ints == volume.ints);
    for (std::size_t size = 0; size < bytes.size(); size += size < 400 ? 1 : 997)
      CHECK_FALSE(read(std::span(bytes).first(size)));
  }
}

TEST_CASE("sparse volume: what is not sound is refused") {
  Rng rng(2);
  const SparseVolume good = random_volume(rng, VolumeType::kFloat, VolumeClass::kFog);
  const auto refused = [&](auto change) {
    SparseVolume volume = good;
    change(volume);
    const auto read_back = read(bytes_of(volume));
    CHECK_FALSE(read_back);
  };
  const double infinite = std::numeric_limits<double>::infinity();
  refused([](SparseVolume& v) { v.leaves[0].origin[1] += 1; });
  refused([](SparseVolume& v) { v.leaves[0].origin = v.leaves[1].origin; });
  refused([](SparseVolume& v) { v.leaves[0].origin[0] = SparseVolume::kReach; });
  refused([](SparseVolume& v) { v.tiles[0].log2_edge = 4; });
  refused([](SparseVolume& v) { v.tiles[0] = v.tiles[1]; });
  refused([&](SparseVolume& v) { v.tiles[0].value[0] = infinite; });
  refused([&](SparseVolume& v) { v.background[0] = std::numeric_limits<double>::quiet_NaN(); });
  refused([](SparseVolume& v) { v.background[0] = 1e300; });
  refused([](SparseVolume& v) { v.index_to_world.rows[1] = v.index_to_world.rows[0]; });
  refused([&](SparseVolume& v) { v.index_to_world.move.x = infinite; });
  refused([](SparseVolume& v) { v.type = VolumeType(9); });
  refused([](SparseVolume& v) { v.floats.pop_back(); });
  SparseVolume infinite_leaf = good;
  infinite_leaf.floats[3] = std::numeric_limits<float>::infinity();
  const auto back = read(bytes_of(infinite_leaf));
  REQUIRE(back);
  CHECK(back->floats[3] == 0);
}

TEST_CASE("sparse volume: damaged bytes are refused or sound") {
  Rng rng(3);
  std::uint64_t read_well = 0;
  for (int round = 0; round < 3000; ++round) {
    static const std::vector<std::byte> good =
        bytes_of(random_volume(rng, VolumeType::kInt, VolumeClass::kUnknown));
    std::vector<std::byte> bytes = good;
    for (std::uint32_t k = 0; k <= rng.below(3); ++k)
      bytes[rng.below(round % 2 ? 600 : std::uint32_t(bytes.size()))] = std::byte(rng.below(256));
    const auto volume = read(bytes);
    if (!volume) continue;
    ++read_well;
    const VolumeLookup lookup(*volume);
    for (int k = 0; k < 5; ++k)
      (void)lookup.interpolate({1e9 * rng.uniform() - 5e8, 60 * rng.uniform() - 30, 60 * rng.uniform() - 30});
    CHECK(volume->ints.size() == volume->number_count());
  }
  CHECK(read_well > 100);
}

TEST_CASE("sparse volume: values are found at leaves, tiles and beyond") {
  SparseVolume volume;
  volume.background[0] = 5;
  volume.leaves.push_back({{-8, 0, 0}, {}});
  for (int v = 0; v < 512; ++v) volume.floats.push_back(float(v));
  volume.tiles = {{{0, 0, 0}, 3, true, {7, 0, 0}},
                  {{128, 0, 0}, 7, true, {8, 0, 0}},
                  {{-4096, -4096, 0}, 12, false, {9, 0, 0}}};
  const VolumeLookup lookup(volume);
  CHECK(lookup.value({-8, 0, 0}) == 0);
  CHECK(lookup.value({-1, 1, 2}) == 7 + 8 + 128);
  CHECK(lookup.value({7, 7, 7}) == 7);
  CHECK(lookup.value({8, 0, 0}) == 5);
  CHECK(lookup.value({255, 127, 127}) == 8);
  CHECK(lookup.value({-1, -1, 4095}) == 9);
  CHECK(lookup.value({-1, -1, 4096}) == 5);
  CHECK(lookup.interpolate({-7.5, 0, 0}) == 0.5);
  CHECK(lookup.interpolate({-7.5, 0.5, 0.25}) == 0.5 + 4 + 16);
  CHECK(lookup.interpolate({7.25, 1, 1}) == 0.75 * 7 + 0.25 * 5);
  CHECK(lookup.nearest({-7.5, 0, 0}) == 1);
  const double far = 1e300;
  CHECK(lookup.interpolate({far, -far, 0}) == 5);
}

TEST_CASE("sparse volume: the range of the active voxels is exact") {
  Rng rng(4);
  for (int round = 0; round < 200; ++round) {
    SparseVolume volume;
    volume.type = VolumeType::kMask;
    VoxelCoord low{1000, 1000, 1000}, high{-1000, -1000, -1000};
    for (int leaf = 0; leaf < 3; ++leaf) {
      volume.leaves.push_back({{8 * leaf, -8 * leaf, 16}, {}});
      for (std::uint32_t k = 0; k < rng.below(4); ++k) {
        const std::uint32_t v = rng.below(512);
        volume.leaves.back().active[v / 64] |= std::uint64_t{1} << (v % 64);
        const VoxelCoord at{8 * leaf + std::int32_t(v % 8), -8 * leaf + std::int32_t(v / 8 % 8),
                            16 + std::int32_t(v / 64)};
        for (std::size_t a = 0; a < 3; ++a)
          low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
      }
    }
    VoxelCoord found_low, found_high;
    const bool any = active_range(volume, found_low, found_high);
    CHECK(any == (high[0] >= 0));
    if (any) {
      CHECK(found_low == low);
      CHECK(found_high == high);
    }
  }
}

TEST_CASE("sparse volume: a dense array becomes one of the same values") {
  Rng rng(6);
  const std::array<std::uint32_t, 3> size{19, 8, 11};
  std::vector<float> values(19 * 8 * 11);
  for (float& v : values) v = rng.below(3) ? float(rng.below(5)) : -2.0f;
  const SparseVolume volume = make_sparse(values, size);
  const VolumeLookup lookup(volume);
  CHECK(volume.background[0] == -2);
  std::size_t i = 0;
  for (std::int32_t z = 0; z < 11; ++z)
    for (std::int32_t y = 0; y < 8; ++y)
      for (std::int32_t x = 0; x < 19; ++x) CHECK(lookup.value({x, y, z}) == double(values[i++]));
  CHECK(lookup.value({19, 0, 0}) == -2);
}
