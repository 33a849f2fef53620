#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a TILE chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_decoder(
      kTileChunk, fuzz::Input(data, size).rest(),
      [](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
        return decode_tile(chunk, budget, sink);
      },
      encode_tile);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds = {encode_tile(test::walkthrough_object().tile)};
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    test::RandomObjectOptions options;
    options.resolution = {4, 4, 4u + std::uint32_t(seed % 3)};
    options.cells = 1 + std::uint32_t(seed % 7);
    options.reach = int(seed % 4);
    options.block = 1 + std::uint32_t(seed % 2);
    Rng rng(seed);
    seeds.push_back(encode_tile(test::random_tile(rng, options)));
  }
  // More than 255 pieces: ids of two bytes.
  test::RandomObjectOptions many;
  many.resolution = {8, 8, 8};
  many.cells = 200;
  many.reach = 3;
  Rng rng(1);
  seeds.push_back(encode_tile(test::random_tile(rng, many)));
  return seeds;
}
