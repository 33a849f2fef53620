#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: the tiles of the grid and the resolution of the tile, a byte an axis each, then a SCOL chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  GridLayout grid;
  for (std::uint32_t& t : grid.tiles) t = 1 + input.number(1) % 24;
  TileMap tile;  // of which the resolution alone matters
  for (std::uint32_t& r : tile.resolution) r = kMinResolution + input.number(1) % 40;
  const auto decode = [&](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
    return decode_surface_colors(chunk, &grid, &tile, budget, sink);
  };
  fuzz::check_decoder(kSurfaceColorChunk, input.rest(), decode, encode_surface_colors);

  // As the validator calls it after faults in other chunks.
  const fuzz::Exact exact(input.rest());
  const ChunkPayload chunk = fuzz::raw_payload(kSurfaceColorChunk, exact.bytes());
  for (const bool has_grid : {false, true}) {
    MemoryBudget budget(fuzz::kLimits);
    IssueSink sink = IssueSink::all(64);
    const auto map =
        decode_surface_colors(chunk, has_grid ? &grid : nullptr, has_grid ? nullptr : &tile, budget, sink);
    MESOCELL_FUZZ_CHECK(has_grid || !map);
    if (!map) continue;
    // Each color is found where it is, and no other.
    std::size_t found = 0;
    for (std::uint64_t t = 0; t < grid.tile_count(); ++t)
      for (std::size_t v = 0; v < map->voxels_per_brick(); ++v)
        if (const Rgb8* const color = map->find(t, v)) MESOCELL_FUZZ_CHECK(color == &map->colors[found++]);
    MESOCELL_FUZZ_CHECK(found == map->colors.size());
  }
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    Rng rng(seed);
    const std::uint32_t most = seed % 8 == 0 ? 30 : 3;
    ByteWriter input;
    Index3 tiles, resolution;
    for (std::uint32_t& t : tiles) input.u8(std::uint8_t((t = 1 + rng.below(seed % 12 == 0 ? 24 : 3)) - 1));
    for (std::uint32_t& r : resolution) {
      r = kMinResolution + rng.below(most);
      input.u8(std::uint8_t(r - kMinResolution));
    }
    const std::uint64_t count = std::uint64_t{tiles[0]} * tiles[1] * tiles[2];
    SurfaceColors map = test::random_surface_colors(rng, resolution, count);
    // Of many tiles, few have a brick.
    if (count > 100) {
      SurfaceColors few = test::random_surface_colors(rng, {4, 4, 4}, 5);
      few.entries.resize(std::size_t(count), SurfaceColors::kNoBrick);
      map = few;
    }
    input.append(encode_surface_colors(map));
    seeds.push_back(input.release());
  }
  return seeds;
}
