#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: the resolution of the tile, 2 bytes an axis, then a GRID chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  Index3 resolution;
  for (std::uint32_t& r : resolution) r = std::clamp(input.number(2), kMinResolution, kMaxResolution);
  const auto decode = [&](const ChunkPayload& chunk, MemoryBudget&, IssueSink& sink) {
    auto grid = decode_grid(chunk, fuzz::kLimits, sink);
    if (grid && !check_extent(chunk, *grid, resolution, sink)) grid.reset();
    return grid;
  };
  fuzz::check_decoder(kGridChunk, input.rest(), decode, encode_grid);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const GridLayout grid = test::random_small_object(seed).grid;
    ByteWriter input;
    for (const std::size_t r : {4 + seed, 512 - seed, std::uint64_t{9}}) input.u16(std::uint16_t(r));
    input.append(encode_grid(grid));
    seeds.push_back(input.release());
  }
  return seeds;
}
