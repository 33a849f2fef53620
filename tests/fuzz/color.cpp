#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a COLR chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_decoder(
      kColorChunk, fuzz::Input(data, size).rest(),
      [](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
        return decode_color(chunk, budget, sink);
      },
      encode_color);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    const auto color = test::random_small_object(seed).color;
    if (color && color->voxels.size() < 100) seeds.push_back(encode_color(*color));
  }
  return seeds;
}
